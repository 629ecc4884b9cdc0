//! Workspace that is kept and grows when it has to.

use faer::dyn_stack::{MemBuffer, MemStack, StackReq};

/// A stack that holds `request`; `None` if there is no memory for it.
pub(super) fn stack(memory: &mut Option<MemBuffer>, request: StackReq) -> Option<&mut MemStack> {
    if !memory.as_mut().is_some_and(|m| MemStack::new(m).can_hold(request)) {
        *memory = None;
        *memory = Some(MemBuffer::try_new(request).ok()?);
    }
    memory.as_mut().map(|m| MemStack::new(m))
}

/// Bytes held.
pub(super) fn bytes(memory: &Option<MemBuffer>) -> usize {
    memory.as_ref().map_or(0, |m| m.len())
}
