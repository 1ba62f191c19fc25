"""The sandbox of a submission; the code inside knows neither answers nor hidden cases.

`launch`, `limits` and `session` run outside, in the worker; `forkserver`, `runner`, `parse` and
`stubs` inside.
"""
