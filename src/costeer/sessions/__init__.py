"""A study with people: plan, order, answers, attempts, and what comes next."""
