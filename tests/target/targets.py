"""A build of the target programs, and running them through its emulator."""
import pathlib
import re
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent


def emulator_of(build):
    """CMAKE_CROSSCOMPILING_EMULATOR of a build's toolchain file; empty on the host."""
    for file in (build / "CMakeFiles").glob("*/CMakeSystem.cmake"):
        found = re.search(r'include\("(.*)"\)', file.read_text())
        if found:
            toolchain = pathlib.Path(found[1])
            break
    else:
        return []
    # A file of its own: tests ask at the same time.
    with tempfile.NamedTemporaryFile("w", suffix=".cmake") as script:
        script.write(f'include("{toolchain}")\nexecute_process(COMMAND ${{CMAKE_COMMAND}} -E echo '
                     '"${CMAKE_CROSSCOMPILING_EMULATOR}")\n')
        script.flush()
        text = subprocess.run(["cmake", "-P", script.name], capture_output=True, text=True, check=True).stdout
    return [part for part in text.strip().split(";") if part]


def program_of(build, name):
    found = [p for p in (build / "bin" / f"{name}.elf", build / "bin" / name) if p.exists()]
    if not found:
        sys.exit(f"{build}/bin has no program {name}")
    return found[0]


class Target:
    def __init__(self, build):
        self.build = pathlib.Path(build)
        self.name = self.build.name
        self.emulator = emulator_of(self.build)
        self.bare_metal = self.name.startswith(("cortex-", "rv32"))

    def program(self, name):
        return program_of(self.build, name)

    def run(self, program, arguments=(), environment=None):
        """(exit status, output) of a program of this build."""
        command = [*self.emulator, self.program(program), *arguments]
        done = subprocess.run([str(c) for c in command], capture_output=True, text=True, env=environment)
        return done.returncode, done.stdout

    def same_lines(self, program, arguments, other):
        """Runs a program here and on `other`: (lines, first line that differs or None)."""
        status, text = self.run(program, arguments)
        other_status, other_text = other.run(program, arguments)
        ours, theirs = text.splitlines(), other_text.splitlines()
        if status or other_status or not ours:
            return len(ours), f"{self.name} ended with {status}, {other.name} with {other_status}"
        differ = [a for a, b in zip(ours, theirs) if a != b]
        if not differ and len(ours) != len(theirs):
            differ = [f"{len(ours)} lines, {len(theirs)} on {other.name}"]
        return len(ours), differ[0] if differ else None
