//! Factors of unsymmetric matrices: P A Q = L U, with partial pivoting.

use faer::{
    Conj, MatMut, Par, Spec,
    dyn_stack::MemBuffer,
    linalg::lu::partial_pivoting::factor::PartialPivLuParams,
    perm::PermRef,
    sparse::{
        SparseColMatRef, SymbolicSparseColMatRef,
        linalg::{
            SymbolicSupernodalParams,
            cholesky::supernodal::factorize_supernodal_symbolic_cholesky_scratch,
            lu::supernodal::{
                SupernodalLu, SymbolicSupernodalLu, factorize_supernodal_numeric_lu,
                factorize_supernodal_numeric_lu_scratch, factorize_supernodal_symbolic_lu, solve_in_place_scratch,
            },
            qr::{
                col_etree, col_etree_scratch, column_counts_aat_scratch, column_counts_ata, postorder,
                postorder_scratch,
            },
        },
    },
};

use super::memory;
use crate::math::ordering;

/// Symbolic and numeric factor of a matrix of symmetric structure, with their workspace.
#[derive(Default)]
pub(super) struct Lu {
    symbolic: Option<SymbolicSupernodalLu<u32>>,
    numeric: SupernodalLu<u32, f64>,
    /// Order of the columns, and its inverse.
    columns: [Vec<u32>; 2],
    /// Order of the rows, by the pivots, and its inverse.
    rows: [Vec<u32>; 2],
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

    /// Symbolic factorisation with the nodes eliminated in `order`, in postorder of the column elimination
    /// tree, which is that of A^T A and bounds the fill whatever the pivots.
    pub fn prepare(&mut self, structure: SymbolicSparseColMatRef<'_, u32>, order: &[u32]) -> Option<()> {
        let n = structure.ncols();
        let request = factorize_supernodal_symbolic_cholesky_scratch::<u32>(n)
            .or(col_etree_scratch::<u32>(n, n))
            .or(postorder_scratch::<u32>(n))
            .or(column_counts_aat_scratch::<u32>(n, n));
        let stack = memory::stack(&mut self.memory, request)?;
        let [forward, inverse] = ordering::unknowns(order);
        let (mut tree, mut post) = (vec![0; n], vec![0; n]);
        let ordered = PermRef::new_checked(&forward, &inverse, n);
        postorder(&mut post, col_etree(structure, Some(ordered), &mut tree, stack), stack);
        let forward: Vec<u32> = post.iter().map(|&k| forward[k as usize]).collect();
        let inverse = ordering::inverted(&forward);

        let ordered = PermRef::new_checked(&forward, &inverse, n);
        let etree = col_etree(structure, Some(ordered), &mut tree, stack);
        postorder(&mut post, etree, stack);
        let (mut counts, mut first) = (vec![0; n], vec![0; n]);
        // the transposed matrix, which is asked for, has the same structure
        column_counts_ata(&mut counts, &mut first, structure, Some(ordered), etree, &post, stack);
        let parameters = SymbolicSupernodalParams { relax: Some(super::RELAX) };
        let symbolic =
            factorize_supernodal_symbolic_lu(structure, Some(ordered), &first, etree, &counts, stack, parameters);
        self.symbolic = Some(symbolic.ok()?);
        self.columns = [forward, inverse];
        self.rows = [vec![0; n], vec![0; n]];
        self.factored = false;
        Some(())
    }

    /// Factors; `transposed` is the transposed matrix. A singular matrix may go through: the residual of a
    /// solution tells.
    pub fn factor(
        &mut self,
        matrix: SparseColMatRef<'_, u32, f64>,
        transposed: SparseColMatRef<'_, u32, f64>,
    ) -> Option<()> {
        self.factored = false;
        let symbolic = self.symbolic.as_ref()?;
        let parameters = Spec::<PartialPivLuParams, f64>::default();
        let request = factorize_supernodal_numeric_lu_scratch::<u32, f64>(symbolic, parameters);
        let stack = memory::stack(&mut self.memory, request)?;
        let [forward, inverse] = &mut self.rows;
        let columns = PermRef::new_checked(&self.columns[0], &self.columns[1], matrix.ncols());
        factorize_supernodal_numeric_lu(
            forward,
            inverse,
            &mut self.numeric,
            matrix,
            transposed,
            columns,
            symbolic,
            Par::Seq,
            stack,
            parameters,
        )
        .ok()?;
        self.factored = true;
        Some(())
    }

    /// Overwrites `x` with A^-1 x, or A^-T x, by the last factor.
    pub fn solve(&mut self, x: &mut [f64], transposed: bool) -> Option<()> {
        if !self.factored {
            return None;
        }
        let n = self.numeric.nrows();
        let stack = memory::stack(&mut self.memory, solve_in_place_scratch::<u32, f64>(n, 1, Par::Seq))?;
        let [rows, columns] = [&self.rows, &self.columns].map(|p| PermRef::new_checked(&p[0], &p[1], n));
        let x = MatMut::from_column_major_slice_mut(x, n, 1);
        if transposed {
            self.numeric.solve_transpose_in_place_with_conj(rows, columns, Conj::No, x, Par::Seq, stack);
        } else {
            self.numeric.solve_in_place_with_conj(rows, columns, Conj::No, x, Par::Seq, stack);
        }
        Some(())
    }

    /// Bytes of the workspace; those of the factor are not told by the library.
    pub fn bytes(&self) -> usize {
        memory::bytes(&self.memory)
    }
}
