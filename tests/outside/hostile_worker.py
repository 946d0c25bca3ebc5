"""Give hostile run files to all commands that read them, and tell what came of it.

`python -W error hostile_worker.py FOLDER COMMANDS KIND:SEED...` with the bases jeffcott.h5 and ring.h5 in FOLDER writes
a line of JSON for each file: its codes, faults, seconds of CPU time and MB of memory beyond those before.
"""

import contextlib
import io
import json
import os
import re
import sys
import time
import traceback
from pathlib import Path

from hostile_runs import hostile

from frbcli.cli.main import run as frb

SETTINGS = ("speed.to=150 Hz", "speed.duration=0.5 s", "output.step=1 ms")
ORDERS = re.compile(r"[^\n -~\xa1-\U0010ffff]")  # what a terminal obeys
PICTURES = (["plot", "RUN"], ["waterfall", "RUN"], ["plot", "RUN", "--what", "summary"])
FEW = (["export", "RUN", "-o", "OUT.csv"], ["plot", "RUN", "--what", "summary", "-o", "OUT.png"])
MANY = (
    ["export", "RUN", "-o", "OUT.csv", "--json"],
    ["export", "RUN", "-o", "OUT.mat", "--format", "mat"],
    ["plot", "RUN", "-o", "OUT.png"],
    ["plot", "RUN", "BASE", "--over", "speed", "-o", "OUT.png"],
    ["plot", "RUN", "--what", "summary", "-o", "OUT.png"],
    ["plot", "RUN", "--what", "orbit", "--from", "0 s", "-o", "OUT.png"],
    ["plot", "RUN", "--what", "displacement", "--from", "0.1 s", "-o", "OUT.svg"],
    ["plot", "RUN", "--what", "ring-speed", "-o", "OUT.png"],
    ["plot", "RUN", "--what", "oil-content", "-o", "OUT.png"],
    ["waterfall", "RUN", "-o", "OUT.png"],
    ["waterfall", "RUN", "--over", "speed", "--cascade", "--window", "0.05 s", "-o", "OUT.pdf"],
    ["waterfall", "RUN", "--direction", "forward", "--log", "--signal", "disk", "-o", "OUT.png", "--json"],
)
RESUME = ["runup", "jeffcott", *(word for setting in SETTINGS for word in ("--set", setting)), "-o", "RUN", "--resume"]


def peak_mb() -> float:
    """The most memory that this process has held since `forget_peak`."""
    status = Path("/proc/self/status").read_text(encoding="ascii")
    found = re.search(r"VmHWM:\s+(\d+) kB", status)
    assert found is not None
    return int(found.group(1)) / 1024


def forget_peak() -> None:
    Path("/proc/self/clear_refs").write_text("5", encoding="ascii")


def call(words: list[str]) -> tuple[int, str, str]:
    """Exit code, stdout and stderr of a command; a traceback is code 1, as for a user."""
    out, told = io.StringIO(), io.StringIO()
    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(told):
        try:
            code = frb(words)
        except BaseException:
            code = 1
            told.write(traceback.format_exc())
    return code, out.getvalue(), told.getvalue()


def faults(words: list[str], code: int, out: str, told: str) -> list[str]:
    """What is wrong with how a command has ended."""
    found = []
    if code not in (0, 2) and not (words[0] == "runup" and code in (3, 130)):
        found.append(f"ends with {code}: {told[-1500:]}")
    if code == 2 and (told.count("frb: ") != 1 or len(told) > 2000):
        found.append(f"says {told[:500]!r}")
    if code == 2 and "--json" not in words and out:
        found.append(f"prints {out[:100]!r}")
    if ORDERS.search(out) or ORDERS.search(told):
        found.append("lets orders to the terminal through")
    return found


def tried(folder: Path, name: str, commands: tuple[list[str], ...]) -> dict[str, object]:
    """One file, given to some commands; to the first only if that refuses it."""
    kind, seed = name.split(":")
    base = folder / ("ring.h5" if int(seed) % 2 else "jeffcott.h5")
    path = folder / f"hostile-{os.getpid()}.h5"
    content = hostile(kind, int(seed), base.read_bytes())
    bad, codes = [], []
    began = before = 0.0
    slowest, most = 0.0, 0.0
    for number, words in enumerate(commands if base.stem == "ring" else [*commands, RESUME]):
        if number == 0 or words[0] == "runup":
            path.write_bytes(content)
        places = {"RUN": str(path), "BASE": str(base)}
        words = [places.get(word, word.replace("OUT", str(path.with_suffix("")))) for word in words]
        forget_peak()
        before, began = peak_mb(), time.process_time()
        code, out, told = call(words)
        slowest, most = max(slowest, time.process_time() - began), max(most, peak_mb() - before)
        codes.append(code)
        bad += [f"{' '.join(words)}: {fault}" for fault in faults(words, code, out, told)]
        if codes == [2]:
            break
    return {"name": name, "codes": codes, "bad": bad, "cpu_s": slowest, "mb": most}


def main() -> None:
    folder, commands = Path(sys.argv[1]), {"few": FEW, "many": MANY}[sys.argv[2]]
    for words in PICTURES:  # what is imported once does not count
        words = [word.replace("RUN", str(folder / "ring.h5")) for word in [*words, "-o", str(folder / "a.png")]]
        code, _, told = call(words)
        assert code == 0, told
    for name in sys.argv[3:]:
        tell({"begun": name})
        tell(tried(folder, name, commands))


def tell(line: dict[str, object]) -> None:
    sys.stdout.write(json.dumps(line) + "\n")
    sys.stdout.flush()


if __name__ == "__main__":
    main()
