"""Tricks that circumvent a withheld tool: code in which labkit's BangBang gives the answer."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Trick:
    """One trick.

    Attributes:
        cell: A cell above the answers.
        body: The body of ``bang_bang(t, duration)``.
        counted: Whether it earns points, so that only the list of tricks reveals it.
        fails: Whether it makes cells fail: the forkserver's objects are hidden from `gc`, and
            without `isinstance` the process that runs the cells cannot read any more.
    """

    body: str
    cell: str = ""
    counted: bool = False
    fails: bool = False

    @property
    def answer(self) -> str:
        """The cell of the answer."""
        return "def bang_bang(t, duration):\n    " + "\n    ".join(self.body.splitlines())


MADE = "unit = lk.BangBang(1.0)"
SCALED = "s, ds, dds = {}\nreturn s, ds / duration, dds / duration**2"
ANEW = "import sys\nfor name in list(sys.modules):\n    if name.partition('.')[0] == 'labkit': del sys.modules[name]\nimport labkit as anew"
OTHER_NAME = "import importlib.util as u\nspec = u.spec_from_file_location('labkit.mine', lk.paths.__file__)\nmine = u.module_from_spec(spec)\nimport sys\nsys.modules['labkit.mine'] = mine\nspec.loader.exec_module(mine)"

KIND = "import operator\nkind = operator.attrgetter('Bang' + 'Bang')(lk)"

TRICKS = {
    "by name": Trick("return lk.BangBang(duration)(t)"),
    "in a library's name": Trick("return lk.BangBang(duration)(t)", "__name__ = 'numpy'"),
    "by another constructor": Trick("return lk.BangBang.within(1.0, 2.0 / duration, 1e15)(t)"),
    "through numpy": Trick("return np.vectorize(lk.BangBang, otypes=[object])(duration).item()(t)"),
    "through map": Trick("return next(map(lk.BangBang, [duration]))(t)"),
    "an instance from an earlier cell": Trick(SCALED.format("unit(t / duration)"), MADE),
    "dataclasses.replace": Trick("import dataclasses\nreturn dataclasses.replace(unit, duration=duration)(t)", MADE),
    "a copy": Trick("import copy\ntwin = copy.copy(unit)\nobject.__setattr__(twin, 'duration', duration)\nreturn twin(t)", MADE),
    "pickle": Trick(SCALED.format("pickle.loads(saved)(t / duration)"), "import pickle\nsaved = pickle.dumps(lk.BangBang(1.0))"),
    "object.__new__": Trick("x = object.__new__(lk.BangBang)\nobject.__setattr__(x, 'duration', duration)\nreturn x(t)"),
    "the saved __init__": Trick("x = object.__new__(kind)\ninit(x, duration)\nreturn x(t)", "kind, init = lk.BangBang, lk.BangBang.__init__"),
    "the closed-over __init__": Trick("return make(duration)(t)", "def maker():\n    kind, init = lk.BangBang, lk.BangBang.__init__\n    def make(T):\n        x = object.__new__(kind)\n        init(x, T)\n        return x\n    return make\nmake = maker()"),
    "the saved __call__": Trick(SCALED.format("call(unit, t / duration)"), f"{MADE}\ncall = lk.BangBang.__call__"),
    "a subclass with its own __init__": Trick("return Mine(duration)(t)", "class Mine(lk.BangBang):\n    def __init__(self, T): object.__setattr__(self, 'duration', T)"),
    "through a trajectory": Trick(SCALED.format("(x[0] for x in ride(t / duration))"), f"{MADE}\nride = lk.Trajectory(lk.Line([0.0], [1.0]), unit)"),
    "getattr, put together": Trick("return getattr(lk, 'Bang' + 'Bang')(duration)(t)"),
    "vars": Trick("return vars(lk)['BangBang'](duration)(t)"),
    "sys.modules": Trick("import sys\nreturn sys.modules['labkit.paths'].BangBang(duration)(t)"),
    "gc": Trick("return kind(duration)(t)", "import gc\nbase = type(lk.Cubic(1.0)).__mro__[1]\nkind = next(x for x in gc.get_referrers(base) if getattr(x, '__name__', '') == 'BangBang')", fails=True),
    "a thread": Trick("import threading\nout = []\nf = lambda: out.append(getattr(lk, 'Bang' + 'Bang')(duration)(t))\nx = threading.Thread(target=f)\nx.start(); x.join()\nreturn out[0]"),
    "a pool of threads": Trick("from concurrent.futures import ThreadPoolExecutor as Pool\nreturn Pool(1).submit(Pool(1).submit(kind, duration).result(), t).result()", KIND),
    "codec.decode": Trick("from labkit.course.serialize import decode\nreturn decode({'$': 'BangBang', 'duration': duration})(t)"),
    "exec with another name": Trick("return f(t, duration)", "names = {'__name__': 'numpy', 'lk': lk}\nexec('def f(t, T): return lk.BangBang(T)(t)', names)\nf = names['f']"),
    "exec with labkit's file": Trick("return f(t, duration)", "names = {'lk': lk}\nexec(compile('def f(t, T): return lk.BangBang(T)(t)', lk.__file__, 'exec'), names)\nf = names['f']", counted=True),
    "deleting and importing again": Trick("return anew.BangBang(duration)(t)", ANEW),
    "loading under another name": Trick("return mine.BangBang(duration)(t)", OTHER_NAME, counted=True),
    "reading the file": Trick("return names['BangBang'](duration)(t)", "names = {'__package__': 'labkit', '__name__': 'labkit.paths'}\nexec(open(lk.paths.__file__).read(), names)", counted=True),
    "patching who is trusted": Trick("return getattr(lk, 'Bang' + 'Bang')(duration)(t)", "import labkit.course.withheld as w\nw._student_asks = lambda: False", counted=True),
    "patching what is found": Trick("return getattr(lk, 'Bang' + 'Bang')(duration)(t)", "import labkit.course.withheld as w\nw.find = lambda name: (None, None)", counted=True),
    "patching isinstance": Trick(SCALED.format("unit(t / duration)"), f"import builtins\nbuiltins.isinstance = lambda *a: False\n{MADE}", fails=True),
}  # fmt: skip
