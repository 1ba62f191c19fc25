"""The sandbox of a submission; the code inside knows neither answers nor hidden cases.

`launch`, `mounts`, `cgroup`, `limits` and `session` run outside, in the worker.
"""
