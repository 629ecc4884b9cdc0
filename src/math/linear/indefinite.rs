//! L B L^T of symmetric matrices that are not positive definite: blocks of one or two rows in B, whose pivots are sought
//! within a supernode only.

use faer::{
    Conj, MatMut, Par, Side, Spec,
    dyn_stack::MemBuffer,
    linalg::cholesky::lblt::factor::LbltParams,
    perm::PermRef,
    sparse::{
        SparseColMatRef, SymbolicSparseColMatRef,
        linalg::{
            SupernodalThreshold, SymbolicSupernodalParams,
            cholesky::{
                CholeskySymbolicParams, IntranodeLbltRef, SymbolicCholesky, SymmetricOrdering,
                factorize_symbolic_cholesky,
            },
        },
    },
};

use super::memory;
use crate::math::ordering;

/// Symbolic and numeric factor with their workspace; all of it is kept between factorisations.
#[derive(Default)]
pub(super) struct Indefinite {
    symbolic: Option<SymbolicCholesky<u32>>,
    made: bool,
    values: Vec<f64>,
    subdiagonal: Vec<f64>,
    forward: Vec<u32>,
    inverse: Vec<u32>,
    memory: Option<MemBuffer>,
}

impl Indefinite {
    pub fn forget(&mut self) {
        self.symbolic = None;
        self.made = false;
    }

    pub fn is_prepared(&self) -> bool {
        self.symbolic.is_some()
    }

    /// Symbolic factorisation with the nodes eliminated in `order`.
    pub fn prepare(&mut self, structure: SymbolicSparseColMatRef<'_, u32>, order: &[u32]) -> Option<()> {
        let [forward, inverse] = ordering::unknowns(order);
        let permutation = PermRef::new_checked(&forward, &inverse, structure.nrows());
        // the automatic choice takes the simplicial path up to some 2,000 cells, at three times the cost
        let parameters = CholeskySymbolicParams {
            supernodal_flop_ratio_threshold: SupernodalThreshold::FORCE_SUPERNODAL,
            supernodal_params: SymbolicSupernodalParams { relax: Some(super::RELAX) },
            ..Default::default()
        };
        let order = SymmetricOrdering::Custom(permutation);
        let symbolic = factorize_symbolic_cholesky(structure, Side::Lower, order, parameters).ok()?;
        self.values.resize(symbolic.len_val(), 0.0);
        self.symbolic = Some(symbolic);
        self.made = false;
        Some(())
    }

    /// L B L^T of a symmetric matrix, singular or not: the residual of a solution tells.
    pub fn factor(&mut self, matrix: SparseColMatRef<'_, u32, f64>) -> Option<()> {
        self.made = false;
        let symbolic = self.symbolic.as_ref()?;
        let n = symbolic.nrows();
        // a column with nothing below its diagonal leaves its entry as it finds it
        self.subdiagonal.clear();
        self.subdiagonal.resize(n, 0.0);
        self.forward.resize(n, 0);
        self.inverse.resize(n, 0);
        let parameters = Spec::<LbltParams, f64>::default();
        let request = symbolic.factorize_numeric_intranode_lblt_scratch::<f64>(Par::Seq, parameters);
        let stack = memory::stack(&mut self.memory, request)?;
        symbolic.factorize_numeric_intranode_lblt(
            &mut self.values,
            &mut self.subdiagonal,
            &mut self.forward,
            &mut self.inverse,
            matrix,
            Side::Lower,
            Par::Seq,
            stack,
            parameters,
        );
        self.made = true;
        Some(())
    }

    /// Overwrites `x` with A^-1 x by the last factor.
    pub fn solve(&mut self, x: &mut [f64]) -> Option<()> {
        let symbolic = self.symbolic.as_ref().filter(|_| self.made)?;
        let n = symbolic.nrows();
        let stack = memory::stack(&mut self.memory, symbolic.solve_in_place_scratch::<f64>(1, Par::Seq))?;
        let x = MatMut::from_column_major_slice_mut(x, n, 1);
        let pivots = PermRef::new_checked(&self.forward, &self.inverse, n);
        let factor = IntranodeLbltRef::new(symbolic, &self.values, &self.subdiagonal, pivots);
        factor.solve_in_place_with_conj(Conj::No, x, Par::Seq, stack);
        Some(())
    }

    /// Bytes of values, pivots and workspace.
    pub fn bytes(&self) -> usize {
        let pivots = 4 * (self.forward.capacity() + self.inverse.capacity());
        8 * (self.values.capacity() + self.subdiagonal.capacity()) + pivots + memory::bytes(&self.memory)
    }
}
