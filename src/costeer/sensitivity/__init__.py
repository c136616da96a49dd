"""Which parameters of the guidance decide what: Sobol indices with pilot drivers."""
