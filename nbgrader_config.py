"""nbgrader's settings for this course: its layout, its stubs, its limits."""

c = get_config()  # noqa: F821  # nbgrader defines it

c.CourseDirectory.course_id = "trajectory_tracking"
c.CourseDirectory.source_directory = "build/course/source"
c.CourseDirectory.release_directory = "assignments"
c.CourseDirectory.submitted_directory = "submitted"
c.CourseDirectory.autograded_directory = "autograded"
c.CourseDirectory.feedback_directory = "feedback"

c.ClearSolutions.code_stub = {
    "python": "# Your code goes here, in place of the next line\nraise NotImplementedError"
}
c.Execute.timeout = 120
