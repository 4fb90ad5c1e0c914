"""Error against run time: what a mission's methods do on its own captures, beside others.

In reading order:

- `measure`: every method timed and measured
- `footprints`: cheaper footprints, to compare with
- `positions`: errors of position, against long double
- `pictures`: pictures by any method, with their seconds and grey levels
- `wind`: what wind does to a mission
- `tables`: the figures for people, and as CSV
- `sentences`: what they mean, in words
- `plots`: diagrams
- `machine`: what times are of
- `page`: all of it on one page
"""
