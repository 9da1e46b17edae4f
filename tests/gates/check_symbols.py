#!/usr/bin/env python3
"""What an object, library or image of the core may refer to: nothing but memory functions, integer
helpers of the compiler, sqrt, fabs and floor. So heap, exceptions, RTTI, libm, stdio and Eigen's
blocked products cannot slip in, and no object keeps state of its own.

usage: check_symbols.py --nm NM [--no-soft-double | --soft-float | --integers] [--with LIBRARY] FILE...
  --with             a library that was checked itself, and whose symbols may be referred to
  --no-soft-double   the CPU has no double: its emulation may not be in the file (for images)
  --soft-float       the CPU has no floating point: its emulation may be in the file
  --integers         nor may it
"""
import argparse
import re
import subprocess
import sys

ALLOWED = re.compile(
    r"^(mem(cpy|move|set|cmp)|(sqrt|fabs|floor)f?"
    r"|__aeabi_(mem(cpy|move|set|clr)[48]?|u?idiv(mod)?|u?ldivmod|lmul|ll?s[lr]|lasr|u?lcmp"
    r"|[fd]2u?lz|u?l2[fd])"
    r"|__popcount[sd]i2|__clz[sd]i2|__ctz[sd]i2|_GLOBAL_OFFSET_TABLE_"
    # RISC-V: products and quotients of 64 bits
    r"|__muldi3|__u?(div|mod)di3|__(ashl|lshr|ashr)di3"
    # x86: which CPU this is, for popcnt; a constant of the compiler's runtime
    r"|__cpu_model)$")
SOFT_DOUBLE = re.compile(r"^__aeabi_(d\w+|c?d(cmp\w*|rcmple)|[fiu]+2d|u?l2d|d2\w+)$")
# The names of Arm's run-time ABI and of libgcc.
SOFT_FLOAT = re.compile(
    r"^(__aeabi_([fd](add|sub|rsub|mul|div|neg|2\w+|cmp\w*)|c[fd]r?cmp\w*|(i|ui|u?l|h)2[fd]\w*)"
    r"|__(add|sub|mul|div|neg|eq|ne|lt|le|gt|ge|cmp|unord|pow)[sdt]f\w*"
    r"|__(fix|float|extend|trunc)\w+)$")
FLOAT_MATHS = re.compile(r"^(sqrt|fabs|floor)f?$")
KNOWN = [
    (re.compile(r"^(malloc|calloc|realloc|free|_\w*alloc_r|_free_r|_?sbrk\w*|aligned_alloc|posix_memalign"
                r"|_Zn[aw]\w*|_Zd[al]\w*)$"), "heap"),
    (re.compile(r"^(__cxa_(throw|begin_catch|end_catch|rethrow|allocate_exception|free_exception)"
                r"|_Unwind\w*|__gxx_personality\w*|_ZSt\d+__throw\w*|__aeabi_unwind\w*)$"),
     "exception"),
    (re.compile(r"^_ZTV?N10__cxxabiv1|^__dynamic_cast$"), "RTTI"),
    (re.compile(r"^(a?(sin|cos|tan)h?|atan2|sincos|exp2?|expm1|log(2|10|1p)?|pow|cbrt|hypot|fmod|ceil"
                r"|l?l?round|l?rint|trunc|fmin|fmax|fma)[fl]?$"), "libm"),
    (re.compile(r"^(_?(f|s|sn|v)*printf\w*|puts|putchar|abort|exit|__assert\w*)$"), "stdio or exit"),
    (re.compile(r"^__cxa_(guard|atexit)\w*$|^__aeabi_atexit$"), "function static or destructor"),
]
DEFINED_FORBIDDEN = [
    (re.compile(r"^_ZT[IS]"), "RTTI"),
    (re.compile(r"gebp_kernel|gemm_pack|general_matrix_matrix_product|triangular_solve_matrix"
                r"|parallelize_gemm|llt_inplace.*blocked"), "blocked Eigen product or solver"),
]
STATE = "BbDdCSs"


def symbols(nm, file):
    listing = subprocess.run([nm, "--format=posix", file], capture_output=True, text=True, check=True)
    for line in listing.stdout.splitlines():
        fields = line.split()
        if len(fields) >= 2 and len(fields[1]) == 1:
            yield fields[0], fields[1]


def defined_in(seen):
    return {name for name, kind in seen if kind not in "Uw"}


def faults(nm, file, is_image, args, known):
    no_soft_double = args.no_soft_double
    seen = list(symbols(nm, file))
    defined = defined_in(seen) | known
    if args.integers:
        for name in sorted({name for name, _ in seen}):
            if SOFT_FLOAT.match(name) or FLOAT_MATHS.match(name):
                yield f"has {name} (floating point)"
    for name in sorted({name for name, kind in seen if kind in "Uw"} - defined):
        if SOFT_FLOAT.match(name) and (args.soft_float or args.integers):
            continue  # allowed, or said above
        if ALLOWED.match(name) or (SOFT_DOUBLE.match(name) and not no_soft_double):
            continue
        why = next((reason for pattern, reason in KNOWN if pattern.match(name)), "not on the list")
        yield f"refers to {name} ({why})"
    for name, kind in seen:
        for pattern, reason in DEFINED_FORBIDDEN:
            if kind not in "Uw" and pattern.search(name):
                yield f"contains {name} ({reason})"
        if is_image and kind not in "Uw":
            if no_soft_double and SOFT_DOUBLE.match(name):
                yield f"contains {name} (double on a single-precision CPU)"
            for pattern, reason in KNOWN:
                if pattern.match(name):
                    yield f"contains {name} ({reason})"
        if not is_image and kind in STATE:
            yield f"keeps state in {name}"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("--nm", default="nm")
    parser.add_argument("--no-soft-double", action="store_true")
    parser.add_argument("--soft-float", action="store_true")
    parser.add_argument("--integers", action="store_true")
    parser.add_argument("--with", dest="library")
    parser.add_argument("files", nargs="+")
    args = parser.parse_args()
    known = defined_in(symbols(args.nm, args.library)) if args.library else set()
    count = 0
    for file in args.files:
        is_image = file.endswith(".elf")
        for fault in faults(args.nm, file, is_image, args, known):
            print(f"{file}: {fault}")
            count += 1
    print(f"{len(args.files)} files, {count} forbidden symbols")
    return 1 if count else 0


if __name__ == "__main__":
    sys.exit(main())
