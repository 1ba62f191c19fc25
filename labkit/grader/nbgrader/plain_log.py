"""What nbgrader's programs say in a terminal, which may hold names that a student chose.

``nbgrader_config.py`` puts this formatter in the place of nbgrader's own.
"""

from __future__ import annotations

import copy
import logging
from typing import Any

from tornado.log import LogFormatter

from ..clean import clean_text


class PlainFormatter(LogFormatter):
    """Writes a log as nbgrader does, without terminal commands in a student's text."""

    def format(self, record: Any) -> str:
        """The record as text, its message cleaned, see `clean_text`."""
        plain: logging.LogRecord = copy.copy(record)
        plain.msg, plain.args = clean_text(record.getMessage()), ()
        return super().format(plain)

    def formatException(self, info: Any) -> str:
        """A traceback, cleaned too."""
        return clean_text(super().formatException(info))
