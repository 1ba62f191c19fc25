"""Attacks on the grader, by class.

An attack is a cell in an otherwise empty notebook, or it replaces a question's function.  It raises
an exception with `GOT ...` when it has obtained something forbidden.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from handmade import add, put


@dataclass(frozen=True)
class Attack:
    """One attack.

    Attributes:
        cell: A cell above the answers.
        answer: The first question's function; NAME stands for its name.
    """

    cell: str = ""
    answer: str = ""

    def planted(self, notebook, at=2, **own):
        """Put the attack into a notebook; words in braces are replaced by values of the test.

        GOT is disguised there, because a traceback shows the line that failed.
        """
        cell, answer = self.cell, self.answer.replace("NAME", "bang_bang")
        for word, value in own.items():
            cell = cell.replace("{" + word + "}", str(value))
        if cell:
            add(notebook, cell.replace("GOT", r"G\x4fT"), at)
        if answer:
            put(notebook, "bang_bang", answer.replace("GOT", r"G\x4fT"))
        return notebook


def cells(**sources: str) -> dict[str, Attack]:
    return {name: Attack(cell=source) for name, source in sources.items()}


def answers(**bodies: str) -> dict[str, Attack]:
    """Attacks from within the function, each given as the body of the function."""
    made = {}
    for name, body in bodies.items():
        lines = "\n    ".join(body.strip().splitlines())
        made[name] = Attack(answer=f"def NAME(t, duration):\n    {lines}")
    return made


def reads(*paths: str) -> dict[str, Attack]:
    return {
        f"read {path}": Attack(
            cell=f"text = open({path!r}, 'rb').read(200)\nif text: raise Exception('GOT ' + repr(text))"
        )
        for path in paths
    }


PATCHED = cells(
    assert_allclose="import numpy as np\nnp.testing.assert_allclose = lambda *a, **k: None",
    array_equal="import numpy as np\nnp.array_equal = np.allclose = np.isclose = lambda *a, **k: True",
    numpy_abs="import numpy as np\nnp.abs = np.absolute = lambda x: np.zeros_like(x)",
    builtin_abs="import builtins\nbuiltins.abs = lambda x: 0.0",
    builtin_isinstance="import builtins\nbuiltins.isinstance = lambda *a: True",
    builtin_all="import builtins\nbuiltins.all = builtins.any = lambda *a: True",
    check_returns="import labkit.course\nlabkit.course.check = lambda *a: 20.0",
    check_in_globals="check = lambda *a: 20.0\nmark = lambda *a: 20.0",
    judge="from labkit.course import judge\njudge.Close.__call__ = lambda *a: None",
    mark="from labkit.course import mark\nmark.mark = lambda *a: 20.0",
    codec_encode="import sys\nfor m in list(sys.modules.values()):\n"
    "    if getattr(m, 'encode', None): m.encode = lambda x: {'is': 'right'}",
    json_dumps='import json\njson.dumps = lambda *a, **k: \'{"is": 1.0, "earned": 20}\'',
    exceptions="import builtins\nbuiltins.AssertionError = type('A', (BaseException,), {})",
)
HOOKS = cells(
    ast_transformer="ip = get_ipython()\nip.ast_transformers.append(lambda t: t)",
    input_transformer="get_ipython().input_transformers_cleanup.append(lambda x: ['pass'])",
    showtraceback="get_ipython().showtraceback = lambda *a, **k: None",
    displayhook="import sys\nsys.displayhook = lambda x: print(20.0)",
    excepthook="import sys\nsys.excepthook = lambda *a: None",
    settrace="import sys\nsys.settrace(lambda *a: None)",
    setprofile="import sys\nsys.setprofile(lambda f, e, a: None)",
    import_hook="import builtins\nold = builtins.__import__\n"
    "builtins.__import__ = lambda n, *a, **k: old('math' if n == 'numpy' else n, *a, **k)",
    meta_path="import sys\nsys.meta_path.clear()",
    audit="import sys\nsys.addaudithook(lambda *a: None)",
    atexit="import atexit\natexit.register(lambda: print('20.0'))",
    post_run_cell="get_ipython().events.register('post_run_cell', lambda *a: None)",
)
_EQUAL = "class All{base}:\n{body}def NAME(t, duration):\n    return {value}"
EQUAL = {
    name: Attack(answer=_EQUAL.format(base=base, body=body, value=value))
    for name, base, body, value in [
        ("eq", "", "    def __eq__(self, o): return True\n", "All()"),
        ("float that equals", "(float)", "    def __eq__(self, o): return True\n", "(All(), All(), All())"),
        ("rsub", "(float)", "    def __rsub__(self, o): return 0.0\n", "[All()] * 3"),
        ("ufunc", "", "    def __array_ufunc__(self, *a, **k): return True\n", "All()"),
        ("array function", "", "    def __array_function__(self, *a, **k): return True\n", "All()"),
        ("array subclass", "(__import__('numpy').ndarray)",
         "    def __sub__(self, o): return self * 0\n", "__import__('numpy').zeros(3).view(All)"),
        ("array once", "", "    def __array__(self, *a, **k): return __import__('numpy').full(3, float('nan'))\n", "All()"),
        ("lt le", "(float)", "    def __le__(self, o): return True\n    def __lt__(self, o): return True\n", "(All(), All(), All())"),
        ("iter for ever", "", "    def __iter__(self):\n        while True: yield 0.0\n", "All()"),
        ("tuple subclass", "(tuple)", "    def __eq__(self, o): return True\n    def __len__(self): return 3\n", "All((0, 0, 0))"),
        ("float protocol", "", "    def __float__(self): return float('nan')\n", "All()"),
        ("type lies", "", "    @property\n    def __class__(self): return tuple\n", "All()"),
    ]
}  # fmt: skip
ODD = answers(
    nan="return float('nan'), float('nan'), float('nan')",
    inf="return float('inf'), 0.0, 0.0",
    true="return True, True, True",
    huge_int="return 10**400, 0, 0",
    longest_int="return 10**5000, 0, 0",
    complex="return 1j, 0, 0",
    deep="x = []\nfor _ in range(5000): x = [x]\nreturn x",
    cyclic="x = []\nx.append(x)\nreturn x",
    object_array="import numpy as np\nreturn np.array([object()] * 3)",
    text="return '0.5', '1', '2'",
    nothing="return None",
    surrogate="return '\\ud800'",
    large="return [0.0] * 5_000_000",
    empty_array="import numpy as np\nreturn np.zeros((0, 10**9))",
)
FRAMES = answers(
    frame_locals="import sys\nf = sys._getframe()\nwhile f:\n"
    "    if 'expected' in f.f_locals or 'case' in f.f_locals: raise Exception('GOT ' + str(f.f_locals))\n"
    "    f = f.f_back\nreturn 0, 0, 0",
    gc_objects="import gc\nfor x in gc.get_objects():\n"
    "    if type(x).__name__ in ('Question', 'Call', 'Test', 'Verdict', 'Mistake'): raise Exception('GOT ' + str(x))\n"
    "return 0, 0, 0",
    gc_dicts="import gc\nfor x in gc.get_objects():\n"
    "    if isinstance(x, dict) and ('hidden' in x or 'expected' in x) and 'case' in x: raise Exception('GOT')\n"
    "return 0, 0, 0",
    traceback="try:\n    raise ValueError\nexcept ValueError as e:\n"
    "    f = e.__traceback__.tb_frame\n    while f.f_back: f = f.f_back\n"
    "    if 'bundle' in f.f_globals: raise Exception('GOT')\nreturn 0, 0, 0",
    modules="import sys\nfor m in sys.modules:\n"
    "    if m.startswith('solutions') or m.endswith(('checker', 'bundle')): raise Exception('GOT ' + m)\n"
    "return 0, 0, 0",
    import_solutions="from solutions.paths.answers import bang_bang\nreturn bang_bang(t, duration)",
    import_reference="import solutions.paths.problems as p\nraise Exception('GOT ' + str(p))",
    withheld="import labkit\nreturn labkit.BangBang(duration)(t)",
    withheld_module="from labkit.paths import BangBang\nreturn BangBang(duration)(t)",
    withheld_subclass="import labkit\nclass Mine(labkit.BangBang): pass\nreturn Mine(duration)(t)",
)
FAKES = cells(
    write_labkit="open('labkit.py', 'w').write('check = 1')\nimport sys\nsys.path.insert(0, '.')",
    write_numpy="import os\nos.makedirs('numpy')\nopen('numpy/__init__.py', 'w').write('')",
    replace_module="import sys, types\nsys.modules['labkit'] = types.ModuleType('labkit')",
    sitecustomize="open('/usr/lib/python3/sitecustomize.py', 'w').write('x')",
    site_packages="import numpy\nopen(numpy.__file__, 'a').write('x = 1')\nraise Exception('GOT write')",
    labkit_file="import labkit\nopen(labkit.__file__, 'a').write('x = 1')\nraise Exception('GOT write')",
    pth="import sysconfig\nopen(sysconfig.get_path('purelib') + '/x.pth', 'w')\nraise Exception('GOT write')",
    del_modules="import sys\nfor m in list(sys.modules):\n    if m.startswith('labkit'): del sys.modules[m]",
)
FILES = reads(
    "../../../solutions/paths/answers.py",
    str(Path(__file__).parents[2] / "solutions" / "paths.py"),
    "{root}/solutions/paths/answers.py",
    "{root}/build/course/bundle/01_paths.json",
    "{root}/gradebook.db",
    "{root}/submitted/student-001/01_paths/01_paths.ipynb",
    "/etc/passwd",
    "/etc/shadow",
    "/proc/1/environ",
    "/proc/self/mem",
    "/proc/kallsyms",
    "/dev/sda",
    "/dev/kmsg",
    "checks.json",
) | cells(
    write_root="open('/x', 'w').write('x')\nraise Exception('GOT write')",
    write_etc="open('/etc/x', 'w').write('x')\nraise Exception('GOT write')",
    list_home="import os\nfound = os.listdir('/home')\nraise Exception('GOT ' + str(found))",
    environment="import os\nbad = [k for k in os.environ if 'PASS' in k or 'TOKEN' in k or 'SECRET' in k]\n"
    "if bad: raise Exception('GOT ' + str(bad))",
    symlink="import os\nos.symlink('/etc/shadow', 'link')\nraise Exception('GOT ' + open('link').read())",
    hard_link="import os\nos.link('/usr/bin/env', 'env')\nraise Exception('GOT link')",
    fill_disk="open('full', 'wb').write(b'x' * 200 * 2**20)\nraise Exception('GOT 200 MB')",
    many_files="import os\nfor k in range(10_000): open(f'f{k}', 'w')\nraise Exception('GOT files')",
    setuid="import os\nopen('s', 'w')\nos.chmod('s', 0o4777)\nos.chown('s', 1, 1)\nraise Exception('GOT')",
    device="import os, stat\nos.mknod('d', stat.S_IFBLK | 0o666, os.makedev(8, 0))\nraise Exception('GOT')",
)  # fmt: skip
NETWORK = cells(
    tcp="import socket\nsocket.create_connection(('1.1.1.1', 53), 2)\nraise Exception('GOT net')",
    udp="import socket\ns = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)\n"
    "s.sendto(b'x', ('1.1.1.1', 53))\nraise Exception('GOT net')",
    loopback="import socket\nsocket.create_connection(('127.0.0.1', 22), 2)\nraise Exception('GOT net')",
    listen="import socket\ns = socket.socket()\ns.bind(('', 0))\ns.listen()\nraise Exception('GOT net')",
    raw="import socket\nsocket.socket(socket.AF_PACKET, socket.SOCK_RAW)\nraise Exception('GOT net')",
    netlink="import socket\nsocket.socket(socket.AF_NETLINK, socket.SOCK_RAW)\nraise Exception('GOT net')",
    dns="import socket\nraise Exception('GOT ' + str(socket.gethostbyname('example.org')))",
    abstract="import socket\ns = socket.socket(socket.AF_UNIX)\n"
    "s.connect('\\0/tmp/.X11-unix/X0')\nraise Exception('GOT net')",
    urllib="import urllib.request as u\nu.urlopen('http://example.org', timeout=2)\nraise Exception('GOT net')",
)  # fmt: skip
SIGNALS = cells(
    kill_parent="import os, signal\nos.kill(os.getppid(), signal.SIGKILL)",
    kill_all="import os, signal\nos.kill(-1, signal.SIGKILL)",
    kill_group="import os, signal\nos.killpg(0, signal.SIGKILL)",
    stop_self="import os, signal\nos.kill(os.getpid(), signal.SIGSTOP)",
    exit="import sys\nsys.exit(0)",
    hard_exit="import os\nos._exit(0)",
    segfault="import ctypes\nctypes.string_at(0)",
    recursion="def f(): f()\nf()",
    closed="import os\nos.closerange(0, 256)",
    threads="import threading, time\nfor _ in range(500):\n    threading.Thread(target=time.sleep, args=(60,), daemon=True).start()",
    forks="import os, time\nfor _ in range(200):\n    if not os.fork():\n        time.sleep(60)\n        os._exit(0)",
    daemon="import os, time\nif not os.fork():\n    os.setsid()\n    if not os.fork():\n        time.sleep(600)\n    os._exit(0)",
    memory="x = bytearray(6 * 10**9)\nraise Exception('GOT memory')",
    input="input()",
    priority="import os\nos.nice(-10)\nraise Exception('GOT priority')",
)  # fmt: skip
ENDLESS = cells(
    loop="while True: pass",
    deaf="import signal\nfor s in (signal.SIGALRM, signal.SIGPROF, signal.SIGXCPU): signal.signal(s, signal.SIG_IGN)\n"
    "while True: pass",
    catches="while True:\n    try:\n        while True: pass\n    except BaseException: pass",
    sleeps="import time\ntime.sleep(1000)",
    in_c="sum(range(10**12))",
    prints="while True: print('x' * 10_000)",
    regex="import re\nre.match('(a+)+b', 'a' * 60)",
)  # fmt: skip
KERNEL = cells(
    ptrace="import ctypes\nif ctypes.CDLL(None).ptrace(0, 0, 0, 0) == 0: raise Exception('GOT ptrace')",
    unshare="import ctypes\nif ctypes.CDLL(None).unshare(0x10000000) == 0: raise Exception('GOT ns')",
    mount="import ctypes\nif ctypes.CDLL(None).mount(b'x', b'/tmp', b'tmpfs', 0, None) == 0: raise Exception('GOT mount')",
    unmount="import ctypes\nif ctypes.CDLL(None).umount2(b'/proc', 2) == 0: raise Exception('GOT umount')",
    setuid="import os\nos.setuid(0)\nif os.getuid() == 0 and open('/etc/x', 'w'): raise Exception('GOT root')",
    chroot="import os\nos.chroot('/tmp')\nraise Exception('GOT chroot')",
    clone_user="import ctypes\nr = ctypes.CDLL(None).syscall(56, 0x10000011, 0, 0, 0, 0)\n"
    "if r > 0: raise Exception('GOT clone')",
    bpf="import ctypes\nif ctypes.CDLL(None).syscall(321, 0, 0, 0) >= 0: raise Exception('GOT bpf')",
    io_uring="import ctypes\nif ctypes.CDLL(None).syscall(425, 1, 0) >= 0: raise Exception('GOT uring')",
    keyring="import ctypes\nif ctypes.CDLL(None).syscall(250, 0, -3, 1) >= 0: raise Exception('GOT keys')",
    sethostname="import socket\nsocket.sethostname('x')\nraise Exception('GOT name')",
    limits="import resource\nresource.setrlimit(resource.RLIMIT_NPROC, (10**4, 10**4))\nraise Exception('GOT limits')",
    x32="import ctypes\nif ctypes.CDLL(None).syscall(0x40000000 + 39) >= 0: raise Exception('GOT x32')",
)  # fmt: skip
_ENDS = (
    "import os, stat\ndef shout(data):\n    for f in range(3, 128):\n        try:\n"
    "            if stat.S_ISSOCK(os.fstat(f).st_mode): os.write(f, data)\n        except OSError: pass\n"
)
FORGERY = cells(
    verdict=_ENDS + "shout(b'{\"earned\": 20, \"outcome\": \"right\"}\\n' * 40)",
    answers=_ENDS + "shout(b'{\"is\": 1.0}\\n' * 400)",
    over=_ENDS + "shout(b'{\"over\": 0}\\n' * 100)",
    ready=_ENDS + "shout(b'{\"ready\": \"bang_bang\"}\\n{\"is\": 1.0}\\n' * 100)",
    not_json=_ENDS + "shout(b'not json\\n' * 100)",
    no_end=_ENDS + "shout(b'x' * 100_000)",
    endless=_ENDS + "import itertools\nfor _ in itertools.count(): shout(b'x' * 65536)",
    deep=_ENDS + "shout(b'[' * 90_000 + b'\\n')",
    pickle=_ENDS + "import pickle\nclass E:\n    def __reduce__(self): return (print, ('GOT',))\n"
    "shout(pickle.dumps(E()) + b'\\n')",
    kind=_ENDS + "shout(b'{\"is\": {\"$\": \"Model\", \"side\": \"left\", \"plant\": null}}\\n' * 100)",
    method=_ENDS + "shout(b'{\"is\": {\"$\": \"method\", \"of\": 1, \"name\": \"__class__\"}}\\n' * 99)",
    read_ahead=_ENDS + "for f in range(3, 128):\n    try:\n        os.set_blocking(f, False)\n"
    "        data = os.read(f, 10**6)\n        if b'hidden' in data or b'expected' in data: raise Exception('GOT ' + str(data))\n"
    "    except OSError: pass",
)  # fmt: skip
FEEDBACK = answers(
    script="raise ValueError('<script>alert(1)</script>')",
    image="raise ValueError('<img src=x onerror=alert(1)>')",
    terminal="raise ValueError('\\x1b[2J\\x1b]0;owned\\x07')",
    newlines="raise ValueError('\\n[999/999] everybody: 20 of 20\\n')",
    override="raise ValueError('\\u202e02 fo 02')",
    long="raise ValueError('x' * 10**7)",
    kind_of_its_own="raise type('GOT ' + repr((t, duration)), (Exception,), {})",
    str_raises="class E(Exception):\n    def __str__(self): raise SystemExit\nraise E",
    formula="raise ValueError('=HYPERLINK(\"http://x\")')",
)  # fmt: skip
FEEDBACK["tells hidden inputs in a public case"] = Attack(
    answer="seen = []\ndef NAME(t, duration):\n    seen.append((t, duration))\n"
    "    if len(seen) > 27: raise ValueError('GOT ' + repr(seen[27:]))\n    return 0, 0, 0"
)

CLASSES: dict[str, dict[str, Attack]] = {
    "patched comparison": PATCHED,
    "display and execution hooks": HOOKS,
    "objects that compare equal": EQUAL,
    "odd answers": ODD,
    "frame walking": FRAMES,
    "fake modules": FAKES,
    "files": FILES,
    "network": NETWORK,
    "signals and processes": SIGNALS,
    "endless": ENDLESS,
    "kernel": KERNEL,
    "protocol forgery": FORGERY,
    "feedback injection": FEEDBACK,
}
