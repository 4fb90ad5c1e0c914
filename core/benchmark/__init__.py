"""Queries that are to be found in references: how well methods find them.

metrics    figures of rankings and of positions, as the field defines them
"""
