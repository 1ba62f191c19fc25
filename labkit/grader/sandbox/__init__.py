"""What runs inside the sandbox: nothing in here knows an answer or a hidden case."""
