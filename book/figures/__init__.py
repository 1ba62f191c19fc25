"""Figures, replays and numbers of the book, made at build; one module for each chapter.

Pages call these functions; readers see what they return and never the code.
"""
