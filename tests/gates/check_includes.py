#!/usr/bin/env python3
"""Holds the arrows between the parts: host_sim -> core, port; port -> core; core -> fixed-size Eigen
and freestanding-friendly headers alone; inside the core and the host simulation downwards only
(BELOW, HOST_BELOW).

usage: check_includes.py ROOT
"""
import pathlib
import re
import sys

INCLUDE = re.compile(r'^\s*#\s*include\s*([<"])([^>"]+)[>"]', re.M)

STANDARD = set("""algorithm array atomic cfloat climits cmath cstddef cstdint cstring initializer_list limits
                  new tuple type_traits utility stdbool.h stddef.h stdint.h""".split())
# SIMD of the compiler itself; vision falls back to plain words where there is none.
INTRINSICS = {"emmintrin.h", "arm_neon.h", "arm_acle.h", "arm_mve.h"}
EIGEN = {"Eigen/Core", "Eigen/Geometry", "Eigen/Cholesky", "Eigen/LU"}

# From the bottom up: each module may use itself and these.
BELOW = {
    "base": "",
    "numeric": "base",
    "vision": "base numeric",
    "geometry": "base numeric",
    "estimation": "base numeric geometry",
    "planar": "base numeric geometry estimation",
    "mono": "base numeric geometry estimation",
    "window": "base numeric geometry estimation",
    "map": "base numeric vision geometry estimation",
    "ar": "base numeric vision geometry",
    "tracking": "base numeric vision geometry estimation planar mono window map",
    "runtime": "base numeric vision geometry estimation planar mono window map tracking ar",
    "c_api": "base numeric vision geometry estimation planar mono window map tracking ar runtime",
}
# Headers that lie in no module's folder, and the module whose rules hold for them. The version's may be
# included by every module.
TOP_HEADERS = {"version.h": "base", "version.hpp": "base", "cairn.h": "c_api"}
# The same of host_sim's folders. A file stands in the deepest of them that its path names.
HOST_BELOW = {
    "base": "",
    "io": "",
    "replay": "",
    "world": "",
    "render": "",
    "view": "",
    "sources": "io world",
    "options": "base sources",
    "trackers": "base options io replay sources",
    "evaluation": "base sources",
    "calibration": "io sources",
    "running": "base io render view sources trackers evaluation",
    "reports": "base io sources trackers evaluation running",
    "timing": "base options io replay sources trackers running reports",
    "recorded": "base options io world trackers evaluation reports",
    "experiments/consistency": "base io world evaluation reports",
    "experiments/turntable": "base io world reports",
    "experiments/relocalisation": "base io replay sources trackers evaluation",
    "experiments/robustness": "base io sources trackers evaluation running",
    "experiments/faults": "base io replay world sources trackers evaluation running reports",
    "experiments/laps": "base io sources trackers",
    "experiments/miscalibration": "base io sources trackers running",
    "experiments/vision": "base io",
    "commands": "base options io world sources calibration trackers evaluation running reports timing recorded "
                "experiments/consistency experiments/turntable experiments/relocalisation "
                "experiments/robustness experiments/faults experiments/laps experiments/miscalibration "
                "experiments/vision",
    "main.cpp": "io options commands",
}


def downwards(below):
    """What each module may use. No module may use a later one, so there is no cycle."""
    allowed = {}
    for module, names in below.items():
        unknown = set(names.split()) - set(allowed)
        if unknown:
            sys.exit(f"check_includes: {module} is listed before {', '.join(sorted(unknown))}")
        allowed[module] = {module, *names.split()}
    return allowed


MODULES = downwards(BELOW)
HOST_FOLDERS = downwards(HOST_BELOW)


def core_module(path):
    parts = path.parts
    if "src" in parts:
        return parts[parts.index("src") + 1]
    inside = parts[parts.index("include") + 1:]
    return TOP_HEADERS.get(inside[1], inside[1])


def core_fault(module, quote, name):
    if name.startswith("cairn/port/"):
        return "the core does not know the port"
    if name.startswith("cairn/"):
        target = name.split("/")[1]
        target = TOP_HEADERS.get(target, target)
        if target in MODULES.get(module, ()):
            return None
        return f"{module} may not use {target}"
    if quote == '"':
        return None if "/" not in name else "core headers are named from cairn/"
    if name in STANDARD or name in EIGEN or (name in INTRINSICS and module == "vision"):
        return None
    return "not a header that the core may use"


def port_fault(name):
    return "the port knows the core alone" if re.match(r"host_sim/|opencv2/|tests/", name) else None


def host_folder(path):
    """The folder of `path`, which is relative to host_sim/; None for one that is not listed."""
    return next((folder for folder in HOST_FOLDERS if path == folder or path.startswith(folder + "/")), None)


def host_fault(path, name):
    if re.match("tests/", name):
        return "host_sim does not know the tests"
    folder = host_folder(path)
    if folder is None:
        return "its folder is not in HOST_BELOW"
    if not name.startswith("host_sim/"):
        return None
    target = host_folder(name[len("host_sim/"):])
    return None if target in HOST_FOLDERS[folder] else f"{folder} may not use {target}"


def fault_of(relative, quote, name):
    if relative.parts[0] == "core":
        return core_fault(core_module(relative), quote, name)
    if relative.parts[0] == "port":
        return port_fault(name)
    return host_fault("/".join(relative.parts[1:]), name)


def main():
    root = pathlib.Path(sys.argv[1])
    faults, files = [], 0
    for top in ("core", "port", "host_sim"):
        for path in sorted((root / top).rglob("*")):
            if path.suffix not in {".hpp", ".h", ".cpp", ".c", ".inc"}:
                continue
            files += 1
            relative = path.relative_to(root)
            for quote, name in INCLUDE.findall(path.read_text()):
                fault = fault_of(relative, quote, name)
                if fault:
                    faults.append(f"{relative}: {name}: {fault}")
    print("\n".join(faults))
    print(f"{files} files, {len(faults)} forbidden includes")
    return 1 if faults or not files else 0


if __name__ == "__main__":
    sys.exit(main())
