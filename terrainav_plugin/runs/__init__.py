"""Captures: the line they wait in, what is asked before them and told after them."""
