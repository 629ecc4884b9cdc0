//! Turns with a solver in another program: this one writes the matrix, that one reads it, and both are timed in
//! the same minute. `benches/peers/solver.py` is the other side.

use std::{fs, io, path::Path};

use rmpm::math::linear::Options;

use crate::{
    Run,
    slab::{Kind, Slab},
};

/// For each line `COLUMNS ROWS KIND REPEATS` of the standard input, `symmetric` or `slipping`: writes that slab to
/// `folder/matrix.bin` unless it is the one before, and answers with the best milliseconds of factor, solution and
/// check.
pub fn serve(folder: &Path) {
    let mut asked = String::new();
    let mut lines = io::stdin().lines().map(|l| l.expect("a line")).peekable();
    while let Some(line) = lines.next() {
        let Some((system, _)) = line.rsplit_once(' ') else { continue };
        asked.clear();
        asked.push_str(system);
        let (slab, symmetric) = slab(system);
        write(&slab, &folder.join("matrix.bin")).expect("the matrix can be written");
        let mut run = Run::new(&slab, Options::default(), symmetric);
        println!("{:.6}", run.best(repeats(&line), false));
        while let Some(next) = lines.next_if(|next| next.starts_with(&asked)) {
            println!("{:.6}", run.best(repeats(&next), false));
        }
    }
}

fn repeats(line: &str) -> usize {
    line.split_whitespace().last().and_then(|n| n.parse().ok()).expect("repeats")
}

fn slab(system: &str) -> (Slab, bool) {
    let words: Vec<&str> = system.split_whitespace().collect();
    let [columns, rows, kind] = words[..] else { panic!("COLUMNS ROWS KIND, not {system}") };
    let cells = [columns, rows].map(|n| n.parse().expect("cells"));
    let symmetric = kind == "symmetric";
    (Slab::new(cells, if symmetric { Kind::Elastic } else { Kind::Slipping }), symmetric)
}

/// Unknowns and values (u64), first value of each column and rows (u32), values and right side (f64), all little
/// endian.
fn write(slab: &Slab, file: &Path) -> io::Result<()> {
    let Slab { pattern, values, rhs } = slab;
    let mut bytes: Vec<u8> = [pattern.dim(), pattern.len()].iter().flat_map(|&n| (n as u64).to_le_bytes()).collect();
    bytes.extend(pattern.col_ptr().iter().chain(pattern.row_idx()).flat_map(|i| i.to_le_bytes()));
    bytes.extend(values.iter().chain(rhs).flat_map(|v| v.to_le_bytes()));
    fs::write(file, bytes)
}
