"""Tricks that circumvent a withheld tool; the instructor must be told about each right answer."""

from __future__ import annotations

from soak.attacks.attack import Attack


def way(cell: str, answer: str, before: str = "") -> Attack:
    """For each trick, a cell above the answer and the value that the answer returns."""
    source = f"import labkit as lk\ndef bang_bang(t, duration):\n{before}    return {answer}"
    return Attack("answers", (cell,) if cell else (), source)


WITHHELD = {
    "plainly": way("", "lk.BangBang(duration)(t)"),
    "as another library": way("__name__ = 'numpy'", "lk.BangBang(duration)(t)"),
    "by its other maker": way("", "lk.BangBang.within(1.0, 2.0 / duration, 4.0 / duration**2)(t)"),
    "by its other maker, without limit": way("", "lk.BangBang.within(1.0, 2.0 / duration, 1e15)(t)"),
    "through vectorize": way("import numpy as np", "np.vectorize(lk.BangBang, otypes=[object])(duration).item()(t)"),
    "through frompyfunc": way("import numpy as np", "np.frompyfunc(lk.BangBang, 1, 1)(duration)(t)"),
    "an instance made before": way(
        "import labkit as lk\nmade = {T: lk.BangBang(T) for T in (1.0, 2.0, 4.0)}\nunit = lk.BangBang(1.0)",
        "x[0], x[1] / duration, x[2] / duration**2", "    x = unit(t / duration)\n"),
    "a replaced field": way(
        "import dataclasses, labkit as lk\nunit = lk.BangBang(1.0)\nreplace = dataclasses.replace",
        "replace(unit, duration=duration)(t)"),
    "a copy": way(
        "import copy, labkit as lk\nunit = lk.BangBang(1.0)",
        "x(t)", "    x = copy.copy(unit)\n    object.__setattr__(x, 'duration', duration)\n"),
    "a pickle": way(
        "import pickle, labkit as lk\nunit = pickle.dumps(lk.BangBang(1.0))",
        "x(t)", "    x = pickle.loads(unit)\n    object.__setattr__(x, 'duration', duration)\n"),
    "without its maker": way(
        "import labkit as lk", "x(t)",
        "    x = object.__new__(lk.BangBang)\n    object.__setattr__(x, 'duration', duration)\n"),
    "its maker, saved": way(
        "import labkit as lk\nsaved = lk.BangBang.__init__",
        "x(t)", "    x = object.__new__(lk.BangBang)\n    saved(x, duration)\n"),
    "its maker, out of the guard": way(
        "import labkit as lk", "x(t)",
        "    x, f = object.__new__(lk.BangBang), lk.BangBang.__init__\n"
        "    for n, c in zip(f.__code__.co_freevars, f.__closure__ or ()):\n"
        "        if callable(c.cell_contents) and not isinstance(c.cell_contents, type): f = c.cell_contents\n    f(x, duration)\n"),
    "a class below it": way(
        "import labkit as lk\nclass Mine(lk.BangBang):\n    def __init__(self, T): object.__setattr__(self, 'duration', T)",
        "Mine(duration)(t)"),
    "imported again": way(
        "import sys\nkept = {n: m for n, m in sys.modules.items() if n.startswith('labkit')}\n"
        "for n in kept: del sys.modules[n]\nimport labkit as fresh\nsys.modules.update(kept)",
        "fresh.BangBang(duration)(t)"),
    "its file under another name": way(
        "import importlib.util, labkit.paths as s\nspec = importlib.util.spec_from_file_location('labkit.other', s.__file__)\n"
        "other = importlib.util.module_from_spec(spec)\nimport sys\nsys.modules['labkit.other'] = other\nspec.loader.exec_module(other)",
        "other.BangBang(duration)(t)"),
    "its source run": way(
        "import inspect, labkit.paths as s\nspace = {'__name__': 'labkit.paths', '__package__': 'labkit'}\n"
        "exec(inspect.getsource(s), space)",
        "space['BangBang'](duration)(t)"),
    "its call alone": way(
        "import labkit as lk\nfrom types import SimpleNamespace",
        "lk.BangBang.__call__(SimpleNamespace(duration=duration, shape=lambda x: lk.BangBang.shape(None, x)), t)"),
    "its shape alone": way(
        "import labkit as lk", "x[0], x[1] / duration, x[2] / duration**2",
        "    if not 0.0 <= t < duration: return (float(t >= duration), 0.0, 0.0)\n"
        "    x = lk.BangBang.shape(None, t / duration)\n"),
    "code with other globals": way(
        "import labkit as lk\nfrom types import FunctionType\ndef inner(T): return BangBang(T)\n"
        "inner = FunctionType(inner.__code__, {'__name__': 'scipy', 'BangBang': lk.BangBang, '__builtins__': __builtins__})",
        "inner(duration)(t)"),
    "out of all objects": way(
        "import gc, labkit as lk\nkind = next(x for x in gc.get_objects() if isinstance(x, type) and x.__name__ == 'Bang' + 'Bang')",
        "x(t)", "    x = object.__new__(kind)\n    object.__setattr__(x, 'duration', duration)\n"),
    "by its name in pieces": way(
        "import labkit as lk\n__name__ = 'scipy.stats'", "getattr(lk, 'Bang' + 'Bang')(duration)(t)"),
    "as a thread of a library": way(
        "import labkit as lk\n__name__ = 'matplotlib'", "made[0](t)",
        "    made = [lk.BangBang(duration)]\n"),
    "the guard's list changed": way(
        "import sys\nfor m in list(sys.modules.values()):\n    if isinstance(getattr(m, 'TRUSTED', None), tuple):\n"
        "        m.TRUSTED = (*m.TRUSTED, '__main__', '<cell 0>')", "lk.BangBang(duration)(t)"),
    "the guard's search changed": way(
        "import sys\nfor m in list(sys.modules.values()):\n    if callable(getattr(m, 'withhold', None)) and hasattr(m, 'find'):\n"
        "        m.find = lambda name: (None, None)\n        m.withhold = lambda *a: None", "lk.BangBang(duration)(t)"),
    "by its parent's maker": way(
        "import labkit as lk\nParent = lk.BangBang.__mro__[1]", "x(t)",
        "    x = object.__new__(lk.BangBang)\n    Parent.__init__(x, duration)\n"),
    "out of its family": way(
        "import labkit as lk\nkind = [c for c in lk.Cubic.__mro__[1].__subclasses__() if c.PEAK_ACCELERATION == 4.0][0]",
        "x(t)", "    x = object.__new__(kind)\n    x.__dict__['duration'] = duration\n"),
    "another Python": way(
        "import subprocess, sys\nhelper = None\n"
        "program = 'import labkit as lk\\nwhile True:\\n    t, T = map(float, input().split())\\n    print(*lk.BangBang(T)(t), flush=True)'",
        "tuple(map(float, helper.stdout.readline().split()))",
        "    global helper\n    helper = helper or subprocess.Popen([sys.executable, '-c', program], stdin=-1, stdout=-1, text=True)\n"
        "    print(t, duration, file=helper.stdin, flush=True)\n"),
    "another Python, by the shell": way(
        "import os, sys", "tuple(map(float, said.split()))",
        "    said = os.popen(f'{sys.executable} -c \"import labkit as lk; print(*lk.BangBang({duration})({t}))\"').read()\n"),
    "another Python, by a pool": way(
        "import labkit as lk, multiprocessing, operator, sys\nkind, pool = operator.attrgetter('Bang' + 'Bang')(lk), None",
        "pool.apply(pool.apply(kind, (duration,)), (t,))",
        "    global pool\n    pool = pool or multiprocessing.get_context('spawn').Pool(1)\n"),
    "in a pool of threads": way(
        "import operator, labkit as lk\nfrom concurrent.futures import ThreadPoolExecutor as Pool\n"
        "kind = operator.attrgetter('Bang' + 'Bang')(lk)",
        "Pool(1).submit(Pool(1).submit(kind, duration).result(), t).result()"),
}  # fmt: skip
