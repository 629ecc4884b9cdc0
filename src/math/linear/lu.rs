//! Factors of unsymmetric matrices: P A Q = L U, with partial pivoting.

use faer::{
    Conj, MatMut, Par, Spec,
    dyn_stack::MemBuffer,
    linalg::lu::partial_pivoting::factor::PartialPivLuParams,
    sparse::{
        SparseColMatRef, SymbolicSparseColMatRef,
        linalg::{
            SupernodalThreshold,
            lu::{LuRef, LuSymbolicParams, NumericLu, SymbolicLu, factorize_symbolic_lu},
        },
    },
};

use super::memory;

/// Symbolic (COLAMD) and numeric factor with their workspace.
#[derive(Default)]
pub(super) struct Lu {
    symbolic: Option<SymbolicLu<u32>>,
    numeric: NumericLu<u32, f64>,
    factored: bool,
    memory: Option<MemBuffer>,
}

impl Lu {
    pub fn forget(&mut self) {
        self.symbolic = None;
        self.factored = false;
    }

    pub fn is_prepared(&self) -> bool {
        self.symbolic.is_some()
    }

    /// Order of the columns and elimination tree.
    pub fn prepare(&mut self, structure: SymbolicSparseColMatRef<'_, u32>) -> Option<()> {
        let parameters = LuSymbolicParams {
            supernodal_flop_ratio_threshold: SupernodalThreshold::FORCE_SUPERNODAL,
            ..Default::default()
        };
        self.symbolic = Some(factorize_symbolic_lu(structure, parameters).ok()?);
        self.factored = false;
        Some(())
    }

    /// Factors; a singular matrix may go through: the residual of a solution tells.
    pub fn factor(&mut self, matrix: SparseColMatRef<'_, u32, f64>) -> Option<()> {
        self.factored = false;
        let symbolic = self.symbolic.as_ref()?;
        let parameters = Spec::<PartialPivLuParams, f64>::default();
        let request = symbolic.factorize_numeric_lu_scratch::<f64>(Par::Seq, parameters);
        let stack = memory::stack(&mut self.memory, request)?;
        symbolic.factorize_numeric_lu(&mut self.numeric, matrix, Par::Seq, stack, parameters).ok()?;
        self.factored = true;
        Some(())
    }

    /// Overwrites `x` with A^-1 x, or A^-T x, by the last factor.
    pub fn solve(&mut self, x: &mut [f64], transposed: bool) -> Option<()> {
        let symbolic = self.symbolic.as_ref().filter(|_| self.factored)?;
        let stack = memory::stack(&mut self.memory, symbolic.solve_in_place_scratch::<f64>(1, Par::Seq))?;
        let x = MatMut::from_column_major_slice_mut(x, symbolic.nrows(), 1);
        let factor = LuRef::new_unchecked(symbolic, &self.numeric);
        if transposed {
            factor.solve_transpose_in_place_with_conj(Conj::No, x, Par::Seq, stack);
        } else {
            factor.solve_in_place_with_conj(Conj::No, x, Par::Seq, stack);
        }
        Some(())
    }

    /// Bytes of the workspace; those of the factor are not told by the library.
    pub fn bytes(&self) -> usize {
        memory::bytes(&self.memory)
    }
}
