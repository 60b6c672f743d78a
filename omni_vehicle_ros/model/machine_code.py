"""Machine code kept on disk, so that a process that finds it there needs no compiler.

numba compiles a function and llvmlite makes an object file of it; who finds that file needs llvmlite alone, which loads
in a tenth of the time and takes a third of the memory. Folders are those of numba's own cache.
"""

import ctypes
import hashlib
import mmap
import os
import struct
import sys
import tempfile
import warnings
from collections.abc import Callable, Iterator
from functools import partial
from importlib.util import find_spec
from pathlib import Path
from typing import Any

from omni_vehicle_ros.model.state import Vector

Numbers = ctypes.Array[ctypes.c_double]
Kernel = Callable[[Numbers, Numbers], None]
"""Reads what to do and the constants of a vehicle, and writes what it finds over the former."""
Source = Callable[[Vector, Vector], None]
"""A kernel in the part of Python that numba compiles; its arguments are pointers there."""

ENTRY = 'kernel'
LIBRARY = 'libm.so.6'
FUNCTIONS = frozenset({'atan', 'atan2', 'cos', 'exp', 'expm1', 'hypot', 'sin', 'sincos'})
"""All that machine code may call: `LIBRARY` has it."""
DIGEST = hashlib.sha256().digest_size

_engines: list[Any] = []  # they own the code


def can_compile() -> bool:
    """Return whether numba is there and switched on (``NUMBA_DISABLE_JIT``); it is not imported for that."""
    if os.environ.get('NUMBA_DISABLE_JIT', '') not in ('', '0'):
        return False
    return find_spec('numba') is not None and find_spec('llvmlite') is not None


def load_kernel(name: str, text: str, source: Callable[[], Source]) -> Kernel | None:
    """Return a kernel from disk, else compile it and keep it there; None where there is no way to compile.

    Parameters
    ----------
    name
        Name for its file.
    text
        Of all modules that it depends on; when it changes it is compiled anew.
    source
        Makes what is to be compiled.
    """
    if not can_compile():
        return None
    machine = _machine_text()
    key = machine + text.encode()
    file = f'{name}-{hashlib.sha256(machine).hexdigest()[:16]}.code'
    code = _kept(file, key)
    try:
        if code is None:
            folder = _writable_folder()
            code = _compiled(source())
            _keep(folder / file, key, code)
    except OSError as error:
        warnings.warn(f'physics run uncompiled, 30 times slower: {error}', RuntimeWarning, 3)
        return None
    return _linked(code)


def _machine_text() -> bytes:
    """Return what machine code depends on beside its source."""
    import llvmlite
    from llvmlite import binding

    numba = find_spec('numba')
    assert numba is not None and numba.origin is not None
    version = Path(numba.origin).with_name('_version.py').read_text(encoding='utf-8')
    features = binding.get_host_cpu_features().flatten()
    return repr((sys.version, version, llvmlite.__version__, binding.get_host_cpu_name(), features)).encode()


def _folders() -> Iterator[Path]:
    """Return where machine code may be: where numba looks, in the same order."""
    here = Path(__file__).resolve().parent
    name = f'{here.name}_{hashlib.sha1(str(here).encode()).hexdigest()}'
    chosen = os.environ.get('NUMBA_CACHE_DIR')
    if chosen:
        yield Path(chosen) / name
    yield here / '__pycache__'
    yield Path(os.environ.get('XDG_CACHE_HOME') or Path.home() / '.cache') / 'numba' / name


def _writable_folder() -> Path:
    for folder in _folders():
        try:
            folder.mkdir(parents=True, exist_ok=True)
            tempfile.TemporaryFile(dir=folder).close()
        except OSError:
            continue
        return folder
    raise OSError('no folder for the machine code can be written to; set NUMBA_CACHE_DIR')


def _kept(file: str, key: bytes) -> bytes | None:
    """Return the code of a file that was made for a key, and has come to no harm since."""
    for folder in _folders():
        try:
            content = (folder / file).read_bytes()
        except OSError:
            continue
        digest, code = content[:DIGEST], content[DIGEST:]
        if digest == hashlib.sha256(key + code).digest():
            return code
    return None


def _keep(path: Path, key: bytes, code: bytes) -> None:
    """Write a file at one stroke: other processes see all of it or nothing."""
    temporary = path.with_suffix(f'.{os.urandom(8).hex()}')
    try:
        temporary.write_bytes(hashlib.sha256(key + code).digest() + code)
        os.replace(temporary, path)
    except OSError:
        temporary.unlink(missing_ok=True)
        raise


def _compiled(source: Source) -> bytes:
    """Return an object file whose function `ENTRY` is the source, as numba compiles it.

    Raises
    ------
    OSError
        It calls more than `FUNCTIONS`.
    """
    from llvmlite import binding
    from numba import njit, types

    pointer = types.CPointer(types.float64)
    # Without fastmath, for the same bits in every process. No check for division by 0, which never happens.
    options = {'error_model': 'numpy', 'no_cpython_wrapper': True, 'no_cfunc_wrapper': True}
    function = njit(types.void(pointer, pointer), **options)(source)
    module = binding.parse_assembly(function.inspect_llvm(function.signatures[0]))
    for found in module.functions:
        if found.name.startswith('NRT_'):  # left over, since no array that is counted is in use
            found.linkage = 'available_externally'
        elif found.linkage is binding.Linkage.external and not found.is_declaration:
            found.name = ENTRY
    code = bytes(_target_machine().emit_object(module))
    outside = _undefined(code) - FUNCTIONS
    if outside:
        raise OSError(f'their machine code calls {", ".join(sorted(outside))}')
    return code


def _undefined(code: bytes) -> set[str]:
    """Return the symbols that an object file wants of others (ELF of 64 bits)."""
    from llvmlite import binding

    sections = {section.name(): section.data() for section in binding.ObjectFileRef.from_data(code).sections()}
    symbols, names = sections[b'.symtab'], sections[b'.strtab']
    wanted = (name for name, _, _, section, _, _ in struct.iter_unpack('IBBHQQ', symbols) if section == 0)
    return {names[name : names.index(b'\0', name)].decode() for name in wanted} - {''}


def _target_machine() -> Any:
    """Return the machine that numba compiles for."""
    from llvmlite import binding

    binding.initialize_native_target()
    binding.initialize_native_asmprinter()
    target = binding.Target.from_default_triple()
    return target.create_target_machine(
        cpu=binding.get_host_cpu_name(),
        features=binding.get_host_cpu_features().flatten(),
        opt=3,
        reloc='static' if target.name.startswith('x86') else 'default',
        codemodel='jitdefault',
        jit=True,
    )


def _linked(code: bytes) -> Kernel:
    """Return the function of an object file; it holds the GIL, and takes less than half of a call by numba."""
    from llvmlite import binding

    binding.load_library_permanently(LIBRARY)
    engine = binding.create_mcjit_compiler(binding.parse_assembly(''), _target_machine())
    engine.add_object_file(binding.ObjectFileRef.from_data(code))
    engine.finalize_object()
    _engines.append(engine)
    function = ctypes.PYFUNCTYPE(None)(engine.get_function_address(ENTRY))
    _hand_back()
    # numba's functions begin with pointers to a result and to an exception, which there never are here.
    nothing = (ctypes.c_void_p * 2)()
    return partial(function, nothing, nothing)


def _hand_back() -> None:
    """Hand back the pages of LLVM's own code: 32 MB that its start touches, and its file still has."""
    library = ctypes.CDLL(None)
    for line in Path('/proc/self/maps').read_text(encoding='utf-8').splitlines():
        place, access, *_, name = line.split()
        if access == 'r-xp' and 'libllvmlite' in name:  # never written to, so nothing is lost
            first, last = (int(end, 16) for end in place.split('-'))
            library.madvise(ctypes.c_void_p(first), ctypes.c_size_t(last - first), mmap.MADV_DONTNEED)
