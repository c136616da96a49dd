"""What participants are asked: instruments and texts as data, answers, scores."""
