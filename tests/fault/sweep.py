"""Run the tools with calls that fail, and look at what they leave behind.

Usage: sweep.py faults|kills|live SHIM INPUTS [--all] [--only CASE]
       [--kind KIND] [--messages]

SHIM is the library of tests/fault/shim.c; INPUTS a folder with the maps and
meshes that faults.sh makes. A line a tool and kind: 'ok' or 'FAIL', how many
runs were made, how many faults came, and for a failure each run's fault, so
that it can be made again. kills: signals just before the n-th system call, and
at moments of the clock; live: the same of the tools as they are, started
without the library. Exit 1 where something failed, 77 without seccomp.
"""
import collections
import errno
import os
import re
import select
import shutil
import signal
import subprocess
import sys
import tempfile
import time

# name: arguments (inputs as @NAME), the outputs
CASES = {
    "pack png": (["rm-pack", "--depth", "@d.png", "--normal", "@n.png",
                  "-s0.1", "-M", "out.d", "-o", "out.png"],
                 ["out.d", "out.png"]),
    "pack exr": (["rm-pack", "--depth", "@d.png", "--normal", "@n.exr",
                  "-s0.1", "-dhalf", "-o", "out.exr"], ["out.exr"]),
    "pack unpack": (["rm-pack", "--unpack", "@p.tiff", "--normal-out",
                     "n.tga", "--depth-out", "d.tga"], ["d.tga", "n.tga"]),
    "aobake png": (["rm-aobake", "-n4", "@d.png", "-o", "out.png"],
                   ["out.png"]),
    "aobake tiff": (["rm-aobake", "-n4", "@d.exr", "-duint16", "-o",
                     "out.tiff"], ["out.tiff"]),
    "aobake stdout": (["rm-aobake", "-n4", "@d.tga", "--format", "tga", "-o",
                       "-"], []),
    "aobake batch": (["rm-aobake", "-n4", "@d.png", "@d.tga", "-O", "."],
                     ["d.png", "d.tga"]),
    "combine": (["rm-combine", "@p.png", "@p.exr", "-o", "out.png"],
                ["out.png"]),
    "rescale-ao": (["rm-rescale-ao", "--scale", "2", "@p.tga", "-o",
                    "out.tga"], ["out.tga"]),
    "quadfit ply": (["rm-quadfit", "@t.obj", "-o", "out.ply"], ["out.ply"]),
    "quadfit gltf": (["rm-quadfit", "@t.glb", "-o", "out.glb"], ["out.glb"]),
    "multilayer png": (["rm-multilayer", "--size", "8x8", "@t.obj", "-o", "m"],
                       ["m_color.png", "m_depth.png", "m_nx.png",
                        "m_ny.png"]),
    "multilayer exr": (["rm-multilayer", "--size", "8x8", "@t.ply", "-o",
                        "m.exr"], ["m.exr"]),
    "roughen": (["rm-roughen", "--angle", "60", "@c.png", "-o", "out.png"],
                ["out.png"]),
    "info text": (["rm-info", "@p.exr"], []),
    "info json": (["rm-info", "--json", "@p.tiff"], []),
    "info deep": (["rm-info", "@m.exr"], []),
    "info sheet": (["rm-info", "@p.png", "--sheet", "sheet.png"],
                   ["sheet.png"]),
    "render": (["rm-render", "--size", "12x9", "--shape", "@t.obj", "@p.png",
                "--buffers", "b.exr", "-o", "out.png"], ["b.exr", "out.png"]),
}

EIO, ENOMEM, ENOSPC = errno.EIO, errno.ENOMEM, errno.ENOSPC
# what is swept: kind, action, mode, and of how many calls in the daily run
FAULTS = [
    ("malloc", ENOMEM, "", 36),
    ("malloc", ENOMEM, "f", 10),
    ("read", EIO, "", 12),
    ("read", "short", "", 6),
    ("write", ENOSPC, "f", 12),
    ("write", EIO, "", 6),
    ("write", "short", "", 6),
    ("write", ENOSPC, "ft", 6),
    ("open", errno.EMFILE, "f", 6),
    ("open", errno.EACCES, "", 6),
    ("tmpfile", EIO, "", 6),
    ("rename", EIO, "", 6),
    ("rename", ENOSPC, "t", 6),
    ("unlink", EIO, "t", 6),
    ("close", EIO, "", 6),
    ("close", ENOSPC, "t", 6),
    ("stat", EIO, "", 6),
    ("seek", EIO, "", 6),
    ("mmap", ENOMEM, "", 6),
    ("mmap", ENOMEM, "f", 6),
    ("sync", EIO, "", 6),
    ("sync", EIO, "t", 6),
    ("dup", errno.EMFILE, "", 6),
    ("pipe", errno.EMFILE, "", 6),
    ("fork", errno.EAGAIN, "", 6),
    ("thread", errno.EAGAIN, "", 6),
]

OLD = b"what was there before\n"
TIME_LIMIT = 30

Result = collections.namedtuple(
    "Result", "status count failed out err files litter")


class Hang(Exception):
    pass


class Case:
    """A tool that has loaded its libraries, and runs as often as asked."""

    def __init__(self, name, shim, inputs, folder, threads=1, env=()):
        self.name = name
        args, self.outputs = CASES[name]
        self.args = [args[0], "-j%d" % threads] + [
            os.path.join(inputs, a[1:]) if a[0] == "@" else a
            for a in args[1:]]
        self.top = tempfile.mkdtemp(dir=folder)
        self.dir = os.path.join(self.top, "work")
        self.env = dict(os.environ, LD_PRELOAD=shim, OMP_WAIT_POLICY="passive", **dict(env))
        self.server = None
        self.old = False
        self.start()
        self.want = None
        for self.old in False, True:
            r = self.run("any:0:5")
            if r.status != 0 or r.litter or r.err:
                raise SystemExit("FAIL %s: it does not even run: %r" %
                                 (name, r))
            assert self.want in (None, (r.out, r.files)), name
            self.want = r.out, r.files
        # where an input cannot be read a second time, the outputs lack the
        # record of what they were made of (--if-changed), and nothing else
        self.bare = {name: {data} for name, data in self.want[1].items()}
        self.bare_out = {self.want[0]}
        for n in 1, 2, 3, 4:
            r = self.run("open:%d:%d" % (n, errno.EACCES))
            if r.status == 0 and same_content(self, r, images_only=True):
                self.bare_out.add(r.out)
                for name, data in r.files.items():
                    self.bare[name].add(data)

    def start(self):
        job_r, self.jobs = os.pipe()
        self.told, told_w = os.pipe()

        self.server = subprocess.Popen(
            self.args, stdin=subprocess.DEVNULL, pass_fds=(job_r, told_w),
            env=dict(self.env, FAULT_SERVER="%d,%d" % (job_r, told_w)))
        os.close(job_r)
        os.close(told_w)
        self.text = b""

    def end(self):
        os.close(self.jobs)
        os.close(self.told)
        self.server.wait()
        shutil.rmtree(self.top)

    def line(self, deadline):
        while b"\n" not in self.text:
            left = deadline - time.monotonic()
            if left <= 0 or not select.select([self.told], [], [], left)[0]:
                raise Hang()
            more = os.read(self.told, 4096)
            if not more:
                self.server.wait()
                raise SystemExit(
                    77 if self.server.returncode == 77 else
                    "FAIL %s: the server ended" % self.name)
            self.text += more
        line, self.text = self.text.split(b"\n", 1)
        return line.split()

    def run(self, spec, kill=None):
        """kill: (seconds, signal)"""
        shutil.rmtree(self.dir, ignore_errors=True)
        os.mkdir(self.dir)
        if self.old:
            for name in self.outputs:
                with open(os.path.join(self.dir, name), "wb") as f:
                    f.write(OLD)
        os.write(self.jobs, ("%s %s\n" % (spec, self.dir)).encode())
        deadline = time.monotonic() + TIME_LIMIT
        hung = False
        pid = int(self.line(deadline)[1])
        if kill is not None:
            time.sleep(kill[0])
            try:
                os.kill(pid, kill[1])
            except ProcessLookupError:
                pass
        try:
            end = self.line(deadline)
        except Hang:
            hung = True
            os.killpg(pid, signal.SIGKILL)
            end = self.line(deadline + TIME_LIMIT)
        # a batch's workers, which die with it
        for _ in range(200):
            try:
                os.killpg(pid, 0)
            except ProcessLookupError:
                break
            time.sleep(0.01)
        else:
            os.killpg(pid, signal.SIGKILL)
            hung = True
        read = lambda p: open(os.path.join(self.dir, p), "rb").read()
        found = os.listdir(self.dir)
        return Result("hangs" if hung else int(end[1]), int(end[2]),
                      int(end[3]), read("../out"),
                      read("../err").decode(errors="replace"),
                      {n: read(n) for n in found if n in self.outputs},
                      {n: read(n) for n in found if n not in self.outputs})


def files_are_whole(case, r):
    """The old bytes, the new bytes, or nothing where there was nothing."""
    for name in case.outputs:
        now = r.files.get(name)
        if now not in case.bare[name] and now != (
                OLD if case.old else None):
            return "%s is damaged" % name
    if r.litter:
        return "it leaves %s" % ", ".join(sorted(r.litter))
    return None


def is_reason(case, err):
    """One line a file that failed, and a count where there are several."""
    lines = [l for l in err.split("\n")
             if not re.match("terminate called|  what", l)]
    if lines.pop() != "":
        return False
    if lines and lines[0] == "":  # libgomp begins with an empty one
        del lines[0]
    if not lines:
        return False
    tool = re.escape(case.args[0])
    # a worker that is gone at once has said nothing but to the batch
    if "batch" in case.name and re.fullmatch(
            tool + ": [12] of 2 failed", lines[-1]):
        return True
    # while one thread tells it another may give up, and say so besides
    gave_up = tool + r": a library (gave up|ended the run): no memory\?"
    if len(lines) == 2 and any(re.fullmatch(gave_up, l) for l in lines):
        del lines[1]
    elif len(lines) > 1 and case.name != "info deep":  # one of each part
        return False
    return all(re.match("(%s: .*(/|\\.|-: |memory|crashed|gave up|written|standard "
                        "output|colour)|libgomp: .*(memory|Thread))" % tool,
                        line) for line in lines)


def same_content(case, r, images_only=False):
    """Whether EXR files that differ hold the same: deflate that gets no memory
    leaves a block as it is."""
    if r.out != case.want[0] and not images_only or set(r.files) != set(case.want[1]):
        return False
    for name, data in r.files.items():
        want = case.want[1][name]
        if data == want:
            continue
        if images_only and not name.endswith(
                (".exr", ".png", ".tga", ".tiff")):
            continue
        if not images_only and not name.endswith(".exr"):
            return False
        said = []
        for folder, bytes_ in ("a", data), ("b", want):
            os.makedirs(os.path.join(case.top, folder), exist_ok=True)
            with open(os.path.join(case.top, folder, name), "wb") as f:
                f.write(bytes_)
            said.append(subprocess.run(
                ["rm-info", "--json", name], stdout=subprocess.PIPE,
                cwd=os.path.join(case.top, folder)).stdout)
        if not images_only and said[0] != said[1] or "multilayer" not in case.name and \
                subprocess.run(["rm-info", "--compare", "a/" + name,
                                "b/" + name], stdout=subprocess.DEVNULL,
                               cwd=case.top).returncode != 0:
            return False
    return True


def judge_fault(case, r, spec):
    if r.status == "hangs":
        return "hangs"
    code = r.status >> 8
    if r.status & 127:
        return "dies of signal %d%s" % (
            r.status & 127, ": " + r.err.strip() if r.err else "")
    if code == 0:
        right = r.out in case.bare_out and set(r.files) == set(
            case.outputs) and all(
                data in case.bare[name] for name, data in r.files.items())
        if not right and not (
                spec[0] == "m" and same_content(case, r)):
            return "exits 0 with other bytes"
        return r.litter and "it leaves %s" % ", ".join(sorted(r.litter))
    if files_are_whole(case, r):
        return files_are_whole(case, r)
    if code != 1:
        return "exits %d: %s" % (code, r.err.strip())
    if not is_reason(case, r.err):
        return "gives no reason: '%s'" % r.err.strip()
    return None


def numbers(count, most):
    """The first of them, and from there on a spread to the last."""
    if count <= most:
        return list(range(1, count + 1))
    first = most // 2
    rest = most - first
    return list(range(1, first + 1)) + sorted(
        {first + 1 + (count - first - 1) * i // max(rest - 1, 1)
         for i in range(rest)})


def sweep(case, kind, action, mode, most, judge, tell):
    """All calls of a kind, or so many of them: runs, faults, what is bad."""
    fault = lambda n: "%s:%d:%s%s" % (kind, n, action, mode and ":" + mode)
    bad = []
    nruns = nfaults = 0
    olds = (False, True) if kind in (
        "rename", "unlink", "tmpfile", "sync", "any") else (None,)
    for old in olds:
        case.old = bool(old)
        count = case.run(fault(0)).count
        for n in numbers(count, most):
            case.old = n % 2 == 1 if old is None else old
            r = case.run(fault(n))
            nruns += 1
            nfaults += r.failed > 0
            why = judge(case, r, fault(n))
            tell(case, fault(n), r)
            if why:
                bad.append("FAULT=%s%s: %s" % (
                    fault(n), " over an old file" if case.old else "", why))
    return nruns, nfaults, bad


def judge_kill(case, r, spec):
    """Dead of the signal that it was given, or done before that came."""
    sig = int(re.search("kill([0-9]+)", spec).group(1))
    if r.status == "hangs":
        return "hangs"
    if r.status != sig and not (r.status == 0 and not r.failed) and \
            not ("batch" in case.name and r.status in (0, 256)):
        return "status %d: %s" % (r.status, r.err.strip())
    if sig == signal.SIGKILL and len(r.litter) == 1:
        # a hidden name between link and rename, the data whole; without
        # O_TMPFILE part of them
        name, data = next(iter(r.litter.items()))
        for out in case.outputs:
            if re.fullmatch(r"\.%s\.[-0-9a-zA-Z]+" % re.escape(out), name) \
                    and (data == case.want[1][out] or ":t" in spec):
                r = r._replace(litter={})
    if r.err and sig == signal.SIGKILL and "batch" not in case.name:
        return "says: " + r.err.strip()
    return files_are_whole(case, r)


def at_moments(case, nkills):
    """SIGKILL by the clock, two threads at work."""
    bad = []
    began = time.monotonic()
    case.run("malloc:0:5")
    took = time.monotonic() - began
    nkilled = 0
    for i in range(nkills):
        case.old = i % 2 == 1
        spec = "malloc:0:kill9%s" % (":t" if i % 4 >= 2 else "")
        r = case.run(spec, (took * i / nkills, signal.SIGKILL))
        nkilled += r.status == signal.SIGKILL
        why = judge_kill(case, r._replace(failed=0), spec)
        if why:
            bad.append("killed after %.4f s: %s" % (took * i / nkills, why))
    return nkills, nkilled, bad


def live(case, inputs):
    """The tool itself, its signals and its status as a shell sees them."""
    env = dict(os.environ)
    env.pop("LD_PRELOAD", None)
    bad = []
    nkilled = nruns = 0
    began = time.monotonic()
    for sig in (None, signal.SIGTERM, signal.SIGINT, signal.SIGHUP):
        for share in (0,) if sig is None else (0.5, 0.85):
            shutil.rmtree(case.dir)
            os.mkdir(case.dir)
            for name in case.outputs:
                with open(os.path.join(case.dir, name), "wb") as f:
                    f.write(OLD)
            with open(os.path.join(case.top, "err"), "wb") as err:
                tool = subprocess.Popen(
                    case.args, cwd=case.dir, env=env, stderr=err,
                    stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL)
            if sig is None:
                tool.wait()
                took = time.monotonic() - began
                continue
            time.sleep(share * took)
            tool.send_signal(sig)
            status = tool.wait()
            nruns += 1
            nkilled += status == -sig
            if status not in (-sig, 0):
                bad.append("%s: status %d" % (sig.name, status))
            time.sleep(0.02 if "batch" in case.name else 0)
            found = {n: open(os.path.join(case.dir, n), "rb").read()
                     for n in os.listdir(case.dir)}
            for name, data in found.items():
                if name not in case.outputs:
                    bad.append("%s leaves %s" % (sig.name, name))
                elif data not in (OLD, case.want[1][name]):
                    bad.append("%s: %s is damaged" % (sig.name, name))
            said = open(os.path.join(case.top, "err")).read()
            if said:
                bad.append("%s: says %s" % (sig.name, said.strip()))
    return nruns, nkilled, bad


def report(case, what, nruns, nfaults, bad, wide):
    print("%s %s: %s, %d of %d runs%s" % (
        "FAIL" if bad else "ok", case.name, what, nfaults, nruns,
        "" if not bad else ", bad: %d" % len(bad)))
    for line in bad[:1000 if wide else 5]:
        print("    " + line)
    sys.stdout.flush()


def main(argv):
    args = argv[1:]

    def option(name):
        if name not in args:
            return None
        i = args.index(name)
        value = args[i + 1]
        del args[i:i + 2]
        return value

    def flag(name):
        if name not in args:
            return False
        args.remove(name)
        return True

    only, kind_only = option("--only"), option("--kind")
    wide, messages = flag("--all"), flag("--messages")
    job, shim, inputs = args
    seen = collections.Counter()
    totals = collections.Counter()
    failed = False

    def tell(case, spec, r):
        if r.err:
            seen[(case.name, r.err.strip())] += 1

    with tempfile.TemporaryDirectory() as folder:
        for name in CASES:
            if only is not None and not re.search(only, name):
                continue
            threads = 2 if "batch" in name or job == "live" else 1
            if job == "live":
                case = Case(name, shim, inputs, folder, threads)
                for what, result in (
                        ("SIGKILL by the clock",
                         at_moments(case, 200 if wide else 12)),
                        ("signals to the tool", live(case, inputs))):
                    report(case, what, *result, wide)
                    totals[what + " sent"] += result[0]
                    totals[what + " died"] += result[1]
                    failed = failed or bool(result[2])
                case.end()
                continue
            if job == "faults":
                plan = [(k, a, m, most, judge_fault)
                        for k, a, m, most in FAULTS]
                env = {"BAKE_FSYNC": "1"}
            else:
                plan = [("any", "kill9", "", 10, judge_kill),
                        ("any", "kill9", "t", 5, judge_kill),
                        ("any", "kill15", "", 5, judge_kill),
                        ("any", "kill2", "t", 5, judge_kill),
                        ("any", "kill1", "", 2, judge_kill)]
                env = {}
            case = Case(name, shim, inputs, folder, threads, env.items())
            for kind, action, mode, most, judge in plan:
                if kind_only not in (None, kind):
                    continue
                nruns, nfaults, bad = sweep(
                    case, kind, action, mode, 10 ** 9 if wide else most,
                    judge, tell)
                what = "%s %s%s" % (kind, action, mode and " " + mode)
                if nruns:
                    report(case, what, nruns, nfaults, bad, wide)
                totals[kind + " runs"] += nruns
                totals[kind + " faults"] += nfaults
                failed = failed or bool(bad)
            case.end()
    print("total: " + ", ".join(
        "%s %d" % item for item in sorted(totals.items())))
    if messages:
        for (name, text), n in sorted(seen.items()):
            print("%6d %s: %s" % (n, name, text))
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv))
