"""Compilation of functions that only compiled code calls, with no code for calls from Python.

For every function Numba also compiles two wrappers, for Python and for C, and its machine code by itself, although
kernels link the function's intermediate code. That is 40 % of the time that kernels take to compile.
"""

import functools
from typing import Any, no_type_check

from numba import _dynfunc, njit  # pyright: ignore[reportAttributeAccessIssue]
from numba.core.codegen import JITCodeLibrary
from numba.core.compiler import CompilerBase, DefaultPassBuilder
from numba.core.compiler_machinery import register_pass
from numba.core.typed_passes import NativeLowering


class InnerLibrary(JITCodeLibrary):
    """Optimized intermediate code of a function, for which no machine code is made."""

    def _finalize_final_module(self) -> None:
        """Make the code ready for linking only."""
        self._finalize_dynamic_globals()
        self._verify_declare_only_symbols()
        self._finalized = True


@register_pass(mutates_CFG=True, analysis_only=False)
class InnerLowering(NativeLowering):
    """Lowering to intermediate code that other functions link; a call from Python raises `TypeError`."""

    _name = "home_mjx_inner_lowering"

    def run_pass(self, state: Any) -> bool:
        """Lower a function as Numba does for functions of its own, and register it for callers."""
        state.library = InnerLibrary(state.targetctx.codegen(), state.func_id.func_qualname)
        flags = state.flags
        flags.no_compile = flags.no_cpython_wrapper = flags.no_cfunc_wrapper = True
        super().run_pass(state)
        made = state["cr"]
        stand_in = _make_stand_in(made.fndesc.qualname)
        state.targetctx.insert_user_function(stand_in, made.fndesc, [state.library])
        state.reload_init.extend(state.library._reload_init)
        state["cr"] = made._replace(cfunc=stand_in)
        return True


class InnerCompiler(CompilerBase):
    """Numba's compiler with `InnerLowering`."""

    def define_pipelines(self) -> list[Any]:
        """Return Numba's only pipeline, in which the lowering is another one."""
        manager = DefaultPassBuilder.define_nopython_pipeline(self.state)
        manager.passes = [(InnerLowering if step is NativeLowering else step, text) for step, text in manager.passes]
        return [manager]


compile_inner = functools.partial(njit, error_model="numpy", pipeline_class=InnerCompiler)


def _make_stand_in(name: str) -> Any:
    """Return a new function object for Python that raises `TypeError`; callers find the compiled function by it."""
    refused = _refused()
    address = refused.library.get_pointer_to_function(refused.fndesc.llvm_cpython_wrapper_name)
    text = "compiled code that only compiled code calls"
    module = refused.fndesc.lookup_module()
    return _dynfunc.make_function(module, name, text, address, refused.environment, (refused.library,))


@functools.cache
def _refused() -> Any:
    """Return the compiled function whose code for Python all stand-ins have."""
    dispatcher = njit(_refuse)
    dispatcher.compile(())
    return dispatcher.overloads[()]


@no_type_check  # whose wrapper Numba could not compile
def _refuse():  # noqa: ANN202
    """Raise `TypeError`, as does any call with arguments."""
    raise TypeError("only compiled code calls this function")
