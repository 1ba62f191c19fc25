"""Attacks on what is secret: expected answers, marks, names, keys; inputs are not."""

from __future__ import annotations

from soak.attacks.attack import CANARY, Attack, answers, cells

_WORD = "(chr(99) + 'anary')"
"""The expression to search for, spelt so that the text of the attack does not contain it."""
assert CANARY.startswith(eval(_WORD))


def reads(**paths: str) -> dict[str, Attack]:
    """Attacks that read secret files, with the kind of file as name."""
    return {
        f"reads {name.replace('_', ' ')}": Attack(
            "reads",
            (
                f"text = open({path!r}, 'rb').read()\nif {_WORD}.encode() in text: raise Exception('GOT ' + repr(text[:80]))",
            ),
        )
        for name, path in paths.items()
    }


FILES = reads(
    answers_from_where_it_works="../../../solutions/paths/answers.py",
    the_bundle="{root}/build/course/bundle/01_paths.json",
    the_source_with_hidden_cases="{root}/build/course/source/01_paths/01_paths.ipynb",
    the_gradebook="{root}/gradebook.db",
    a_classmates_work="{root}/submitted/zoe/01_paths/01_paths.ipynb",
    a_classmates_result="{root}/results/01_paths/zoe.json",
    the_terms_seed="{root}/course_private/term.json",
    the_exchange="{exchange}/inbound/zoe/01_paths.ipynb",
    the_key_at_home="{root}/home/.ssh/id_ed25519",
    the_environment_of_the_grader="/proc/1/environ",
) | cells(
    "reads",
    environment=f"import os\nfound = [k for k, v in os.environ.items() if {_WORD} in v]\n"
    "if found: raise Exception('GOT ' + str(found))",
    words_of_any_process="import glob\nfor path in glob.glob('/proc/[0-9]*/cmdline'):\n"
    "    raise Exception('GOT ' + path)",
    open_files="import os\nfound = [x for x in os.listdir('/proc/self/fd') if os.path.islink('/proc/self/fd/' + x)]\n"
    "raise Exception('GOT ' + str(found))",
    inherited_lines=f"import os, select\nfor f in range(3, 128):\n    try:\n        os.set_blocking(f, False)\n"
    f"        data = os.read(f, 10**6)\n        if {_WORD}.encode() in data: raise Exception('GOT ' + str(data[:80]))\n"
    "    except OSError: pass",
    peeks_at_the_calls_to_come="import socket\nfor f in range(3, 128):\n    try:\n"
    "        s = socket.socket(fileno=os.dup(f))\n        data = s.recv(10**6, socket.MSG_PEEK | socket.MSG_DONTWAIT)\n"
    f"        if {_WORD}.encode() in data: raise Exception('GOT ' + str(data[:80]))\n    except OSError: pass".replace("import socket", "import os, socket", 1),
    walks_the_disk="import os\nskipped = ('/proc', '/sys', '/usr', '/dev', '/lib', '/snap')\nfor top in ('{root}', '/etc', '/opt', '/srv', '/mnt', '/media', '/tmp', '/var', '/work', '/root', '/home'):\n"
    "    for folder, names, files in os.walk(top):\n"
    "        names[:] = [n for n in names if n not in ('.venv', 'lib', 'node_modules', '.git', '.pyenv', '.cache')][:200]\n"
    "        for name in files:\n            if name.endswith(('.ipynb', '.db')):\n"
    f"                if {_WORD}.encode() in open(os.path.join(folder, name), 'rb').read(): raise Exception('GOT ' + name)",
    a_link_to_the_bundle="import os\nos.symlink('{root}/build/course/bundle/01_paths.json', 'link')\n"
    f"if {_WORD} in open('link').read(): raise Exception('GOT')",
)  # fmt: skip

NETWORK = cells(
    "reads",
    a_server_on_this_machine="import socket\ns = socket.create_connection(('127.0.0.1', {port}), 2)\n"
    "raise Exception('GOT ' + str(s.recv(9)))",
    a_listener="import socket\ns = socket.socket()\ns.bind(('127.0.0.1', 0))\ns.listen()\nraise Exception('GOT')",
    a_socket_without_a_file="import socket\ns = socket.socket(socket.AF_UNIX)\ns.connect('\\0labkit-test-{port}')\n"
    "raise Exception('GOT')",
    a_socket_in_a_folder="import socket\ns = socket.socket(socket.AF_UNIX)\ns.connect('{loot}/socket')\nraise Exception('GOT')",
    netlink="import socket\nsocket.socket(socket.AF_NETLINK, socket.SOCK_RAW)\nraise Exception('GOT')",
)  # fmt: skip

INSIDE = answers(
    "reads",
    locals_of_frames="import sys\nframe = sys._getframe()\nwhile frame:\n"
    "    if 'expected' in frame.f_locals: raise Exception('GOT ' + str(frame.f_locals['expected']))\n"
    "    frame = frame.f_back\nreturn 0, 0, 0",
    objects_of_the_collector="import gc\nfor x in gc.get_objects():\n"
    f"    if isinstance(x, (dict, list, tuple)) and len(x) < 50 and {_WORD} in repr(x)[:20000]: raise Exception('GOT')\nreturn 0, 0, 0",
    modules="import sys\nfor name in sys.modules:\n    if name.startswith(('solutions', 'labkit.grader.', 'naive')) and not name.startswith(('labkit.grader.sandbox', 'labkit.grader.clean')): raise Exception('GOT ' + name)\n"
    "return 0, 0, 0",
    problems="import solutions.paths.problems as p\nraise Exception('GOT ' + str(p))",
)  # fmt: skip

_SYSCALLS = {
    "ptrace": "libc.ptrace(0, 0, 0, 0) == 0",
    # the last argument lies on the stack, where an int leaves half of its 8 bytes to chance
    "memory of another process": "libc.syscall(310, os.getpid(), None, 0, None, 0, ctypes.c_long(0)) == 0",
    "a namespace": "libc.unshare(0x00020000) == 0",
    "a user of a namespace": "(r := libc.syscall(56, 0x10000011, 0, 0, 0, 0)) > 0 or (r == 0 and os._exit(0))",
    "a mount": "libc.mount(b'x', b'/mnt', b'tmpfs', 0, None) == 0",
    "a mount, the new way": "libc.syscall(430, b'tmpfs', 0) >= 0",
    "chroot": "libc.chroot(b'/tmp') == 0",
    "a file by its handle": "libc.syscall(303, -100, b'/usr', (ctypes.c_int * 40)(128), ctypes.byref(ctypes.c_int()), 0) == 0",
    "the kernel's ring of keys": "libc.syscall(250, 0, -3, 1) >= 0",
    "a filter for the kernel": "libc.syscall(321, 5, None, 0) >= 0 or ctypes.get_errno() not in (1, 38)",
    "io_uring": "libc.syscall(425, 1, (ctypes.c_char * 120)()) >= 0",
    "counters of the processor": "libc.syscall(298, (ctypes.c_uint32 * 30)(1, 120), 0, -1, -1, 0) >= 0",
    "what others open": "libc.inotify_init1(0) >= 0",
    "which pages are in memory": "libc.syscall(451, os.open('{marker}', 0), (ctypes.c_uint64 * 2)(0, 1), (ctypes.c_uint64 * 5)(), 0) == 0",
    "another user": "libc.setresuid(0, 0, 0) == 0 and os.getuid() == 0",
    "a higher priority": "libc.setpriority(0, 0, -10) == 0",
}  # fmt: skip
KERNEL = {
    f"kernel: {name}": Attack(
        "reads",
        (f"import ctypes, os\nlibc = ctypes.CDLL(None, use_errno=True)\nif {test}: raise Exception('GOT it')",),
    )
    for name, test in _SYSCALLS.items()
}  # fmt: skip

SECRETS = {**FILES, **NETWORK, **INSIDE, **KERNEL}
