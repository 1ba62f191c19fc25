"""nbgrader's settings for this course: its layout, its stubs, its limits."""

import tomllib
from pathlib import Path

c = get_config()  # noqa: F821  # nbgrader defines it

rules = Path(__file__).with_name("course.toml")
rules = tomllib.loads(rules.read_text(encoding="utf-8-sig")) if rules.exists() else {}
c.CourseDirectory.course_id = rules.get("id", "trajectory_tracking")
c.CourseDirectory.source_directory = "build/course/source"
c.CourseDirectory.release_directory = "assignments"
c.CourseDirectory.submitted_directory = "submitted"
c.CourseDirectory.autograded_directory = "autograded"
c.CourseDirectory.feedback_directory = "feedback"

c.ClearSolutions.code_stub = {
    "python": "# Your code goes here, in place of the next line\nraise NotImplementedError"
}
c.ClearSolutions.text_stub = "*Double-click here and write your text in place of this line.*"
c.Execute.timeout = 120

# What students wrote is shown to teachers without anything in it that runs.
c.HTMLExporter.sanitize_html = True
c.HTMLExporter.filters = {
    "markdown2html": "labkit.grader.feedback.markdown",
    "clean_html": "labkit.grader.feedback.clean",
}

# Students' code never runs in nbgrader's own process: `labkit grade` grades, in a sandbox, and
# `labkit feedback` writes the pages.
c.Autograde.sanitize_preprocessors = ["labkit.grader.gradebook.Refused"]
c.GenerateFeedback.preprocessors = ["labkit.grader.gradebook.Refused"]
