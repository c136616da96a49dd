"""Driver, method and plant closed into one trial, and the record that it leaves."""
