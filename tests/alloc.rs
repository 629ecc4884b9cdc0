//! A step allocates nothing, unless the active nodes pass their high-water mark.

mod support;

use std::{
    alloc::{GlobalAlloc, Layout, System},
    cell::Cell,
};

use support::{SLOPE, advance, simulation, yielded};

/// The system's allocator, counting for each thread.
struct Counting;

thread_local! {
    static COUNT: Cell<u64> = const { Cell::new(0) };
}

fn note() {
    // a thread that is being torn down counts nothing
    let _ = COUNT.try_with(|c| c.set(c.get() + 1));
}

// SAFETY: every call is handed to the system's allocator as it is.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        note();
        unsafe { System.alloc(layout) }
    }
    unsafe fn alloc_zeroed(&self, layout: Layout) -> *mut u8 {
        note();
        unsafe { System.alloc_zeroed(layout) }
    }
    unsafe fn realloc(&self, at: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        note();
        unsafe { System.realloc(at, layout, size) }
    }
    unsafe fn dealloc(&self, at: *mut u8, layout: Layout) {
        unsafe { System.dealloc(at, layout) }
    }
}

#[global_allocator]
static COUNTING: Counting = Counting;

fn allocations() -> u64 {
    COUNT.with(Cell::get)
}

/// Steps through the failure; every step that allocates must have grown the nodal columns.
fn run_through_failure(keys: &[&str], steps: usize) {
    let mut sim = simulation(SLOPE, keys);
    advance(&mut sim, 200);
    let mut wrong = Vec::new();
    let growths_before = sim.work.node_growths;
    for _ in 0..steps {
        let (before, growths) = (allocations(), sim.work.node_growths);
        advance(&mut sim, 1);
        let made = allocations() - before;
        if made > 0 && sim.work.node_growths == growths {
            wrong.push((sim.work.steps, made));
        }
    }
    assert!(yielded(&sim) > 0.4, "the slope has not failed: {} yielded", yielded(&sim));
    assert!(sim.work.sorts > 0, "no sort was watched");
    assert!(sim.work.node_growths - growths_before < 8);
    assert!(
        wrong.is_empty(),
        "{} of {steps} steps allocate, such as (step, times) {:?}",
        wrong.len(),
        &wrong[..wrong.len().min(8)]
    );
}

#[test]
fn the_allocator_counts() {
    let before = allocations();
    drop(std::hint::black_box(Box::new(1u8)));
    assert_eq!(allocations() - before, 1);
}

#[test]
fn no_step_allocates_on_coarse_cells() {
    run_through_failure(&["grid.cell=0.5", "gravity.schedule=at_once"], 1500);
}

#[test]
fn no_step_allocates_on_the_papers_cells() {
    run_through_failure(&["gravity.schedule=at_once"], 1500);
}

#[test]
fn no_step_allocates_with_domains() {
    run_through_failure(&["grid.cell=0.5", "gravity.schedule=at_once", "solver.shape=gimp"], 1500);
}

#[test]
fn no_step_allocates_with_nonlocal_softening() {
    let nonlocal = ["material.clay.regularisation=nonlocal", "material.clay.reference_length=1"];
    run_through_failure(&[&["grid.cell=0.5", "gravity.schedule=at_once"], &nonlocal[..]].concat(), 1500);
}

#[test]
fn no_step_allocates_with_other_transfers() {
    for keys in [["solver.transfer=apic", "solver.shape=bspline"], ["solver.transfer=xpic", "solver.xpic_order=3"]] {
        run_through_failure(&[&["grid.cell=0.5", "gravity.schedule=at_once"][..], &keys].concat(), 1500);
    }
}

#[test]
fn no_step_allocates_with_every_effect() {
    let keys = [
        "grid.cell=0.5",
        "gravity.schedule=at_once",
        "jitter.strength=0.01",
        "damping.viscous=0.01",
        "damping.local=0.001",
        "load=[{box=[[0, 4], [9, 5]], force=[0, -1]}]",
        "drive=[{box=[[0, 0], [1, 1]], velocity_x=0.01}]",
    ];
    run_through_failure(&keys, 1500);
}

/// Implicit steps in which the structure of the equations stays, for symmetric and for
/// unsymmetric systems.
fn run_implicitly(keys: &[&str]) {
    let all = ["solver.scheme=implicit", "grid.cell=0.5", "implicit.regime=newmark", "implicit.time_step=0.01"];
    let mut sim = simulation(SLOPE, &[&all, keys].concat());
    advance(&mut sim, 60);
    let mut wrong = Vec::new();
    for _ in 0..60 {
        let (before, symbolic) = (allocations(), sim.work.symbolic_factorisations);
        advance(&mut sim, 1);
        let made = allocations() - before;
        if made > 0 && sim.work.symbolic_factorisations == symbolic {
            wrong.push((sim.work.steps, made));
        }
    }
    assert!(wrong.is_empty(), "steps that allocate: {:?}", &wrong[..wrong.len().min(8)]);
}

#[test]
fn no_implicit_step_allocates_with_cholesky() {
    run_implicitly(&["boundary.base.kind=fixed", "material.clay.strength_measure=kirchhoff"]);
}

#[test]
fn no_implicit_step_allocates_with_smoothed_dilatation() {
    let keys = ["boundary.base.kind=fixed", "material.clay.strength_measure=kirchhoff", "solver.locking=b_bar"];
    run_implicitly(&keys);
}
