"""Fits of the rivals of the intention network, a file each; all of spec section 9."""
