"""The sandbox of a submission; what runs inside knows no answer and no hidden case.

`launch`, `mounts`, `cgroup`, `limits` and `session` are the worker's side of it, outside.
"""
