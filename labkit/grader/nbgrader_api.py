"""nbgrader's interface to a course, for the steps that nbgrader itself does."""

from __future__ import annotations

import logging
import os
import re
import sys
import tomllib
from pathlib import Path
from typing import Any

from ..course.authoring.layout import Course
from ..errors import LabkitError
from .clean import clean_line

_CONFIG = "nbgrader_config.py"


def nbgrader_api(course: Course) -> Any:
    """The interface of nbgrader, configured by ``nbgrader_config.py``.

    An archived term has none, so that of the course in which it lies is used.

    Raises:
        LabkitError: That file cannot be run.
    """
    from nbgrader.apps import NbGraderAPI
    from nbgrader.coursedir import CourseDirectory
    from traitlets.config import Config
    from traitlets.config.loader import PyFileConfigLoader

    here = str(Path(sys.executable).parent)  # nbgrader calls programs that lie beside Python
    if here not in os.environ["PATH"].split(os.pathsep):
        os.environ["PATH"] = os.pathsep.join([here, os.environ["PATH"]])
    homes = [x for x in (course.root, *course.root.parents[:2]) if (x / _CONFIG).exists()]
    try:
        config = PyFileConfigLoader(_CONFIG, path=str([*homes, course.root][0])).load_config()
    except tomllib.TOMLDecodeError as error:  # the rules, which it reads
        raise LabkitError(f"{course.root / 'course.toml'}: {error}; correct that line") from None
    except (Exception, SystemExit) as error:  # it is a program that the instructor wrote
        why = clean_line(f"{type(error).__name__}: {error}")
        raise LabkitError(f"nbgrader_config.py cannot be run: {why}; correct it") from None
    settings = Config(config)
    settings.CourseDirectory.root = str(course.root)
    settings.Application.log_level = logging.CRITICAL
    return NbGraderAPI(CourseDirectory(config=settings), config=settings)


def reason(result: dict[str, Any]) -> str:
    """Why nbgrader failed: the last exception in its log, or else the log's last line."""
    lines = [x for x in f"{result.get('log', '')}\n{result.get('error', '')}".splitlines() if x]
    errors = [x.strip() for x in lines if re.match(r"\s*[\w.]+(Error|Exception)\b", x)]
    return clean_line((errors or lines or ["nbgrader gave no reason"])[-1])
