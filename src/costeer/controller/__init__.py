"""The paper's controller: one stage a file, in the order in which they run."""
