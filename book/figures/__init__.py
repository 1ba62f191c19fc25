"""Figures, replays and numbers of the book, made when it is built; one module for each chapter.

The pages call these functions.  Readers see the results and not the code.
"""
