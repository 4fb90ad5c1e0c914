"""Error against run time of a mission, and the methods it is compared with."""
