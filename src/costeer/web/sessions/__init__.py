"""The pages of a study with people: participant's page and experimenter's console."""
