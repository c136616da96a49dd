"""A study with people: its plan, its questionnaires, its steps and what they leave."""
