//! The folder of a run: locked while it runs, never laid over something else, frames numbered.

use std::{
    fs::{self, File},
    io::{self, Write},
    path::{Path, PathBuf},
};

use super::{history::History, vtk};
use crate::{
    run::{Observer, Sample},
    snapshot::Snapshot,
};

/// What marks a folder as ours.
const LOCK: &str = ".rmpm-lock";

/// An open run folder.
pub struct Folder {
    path: PathBuf,
    _lock: File,
    pub history: History,
    frames: Vec<(f64, String)>,
    write_frames: bool,
}

/// Makes the folder and takes its lock, without touching what an earlier run left there yet.
///
/// # Errors
/// `AlreadyExists` for a folder that holds something else than a run; `WouldBlock` for one in
/// which a run is under way; those of the file system.
pub fn claim(path: &Path) -> io::Result<File> {
    let foreign = fs::read_dir(path).is_ok_and(|mut entries| entries.next().is_some()) && !path.join(LOCK).exists();
    if foreign || path.is_file() {
        let text =
            format!("'{}' exists and is no run of rmpm: it is not overwritten; choose another --out", path.display());
        return Err(io::Error::new(io::ErrorKind::AlreadyExists, text));
    }
    fs::create_dir_all(path)?;
    let lock = File::options().create(true).append(true).open(path.join(LOCK))?;
    lock.try_lock().map_err(|_| {
        io::Error::new(io::ErrorKind::WouldBlock, format!("another run is writing to '{}'", path.display()))
    })?;
    Ok(lock)
}

impl Folder {
    /// Claims the folder, clears what an earlier run left, and writes the resolved case.
    pub fn open(path: &Path, case_toml: &str, write_frames: bool) -> io::Result<Self> {
        let lock = claim(path)?;
        clear(path)?;
        fs::create_dir_all(path.join("frames"))?;
        fs::create_dir_all(path.join("pictures"))?;
        write_text(&path.join("case.toml"), case_toml)?;
        let history = History::create(&path.join("history.csv"))?;
        Ok(Folder { path: path.to_owned(), _lock: lock, history, frames: Vec::new(), write_frames })
    }

    /// Where it is.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Times and files of the frames so far.
    pub fn frames(&self) -> &[(f64, String)] {
        &self.frames
    }

    /// Writes a JSON file.
    pub fn write_json(&self, name: &str, value: &impl serde::Serialize) -> io::Result<()> {
        let text = serde_json::to_string_pretty(value).map_err(io::Error::other)?;
        write_text(&self.path.join(name), &(text + "\n"))
    }
}

/// Removes what a run writes, and nothing else.
fn clear(path: &Path) -> io::Result<()> {
    for name in ["record.json", "timing.json", "history.csv", "run.pvd", "case.toml"] {
        remove(fs::remove_file(path.join(name)))?;
    }
    for name in ["frames", "pictures"] {
        remove(fs::remove_dir_all(path.join(name)))?;
    }
    Ok(())
}

fn remove(result: io::Result<()>) -> io::Result<()> {
    match result {
        Err(e) if e.kind() != io::ErrorKind::NotFound => Err(e),
        _ => Ok(()),
    }
}

/// Writes a text file whole or not at all.
pub fn write_text(path: &Path, text: &str) -> io::Result<()> {
    super::atomic::write(path, |w| w.write_all(text.as_bytes()))
}

impl Observer for Folder {
    fn sample(&mut self, sample: &Sample) -> io::Result<()> {
        self.history.push(sample)
    }

    fn frame(&mut self, snapshot: &Snapshot) -> io::Result<()> {
        // the frame of an onset comes late
        let place = self.frames.partition_point(|(t, _)| *t < snapshot.time);
        if self.frames.get(place).is_some_and(|(t, _)| *t == snapshot.time) {
            return Ok(());
        }
        let name = format!("frames/{:05}.vtp", self.frames.len());
        vtk::write_vtp(&self.path.join(&name), snapshot)?;
        self.frames.insert(place, (snapshot.time, name));
        self.history.flush()?;
        // the index is written anew with each frame, so that a run cut short can be looked at
        vtk::write_pvd(&self.path.join("run.pvd"), &self.frames)
    }

    fn wants_frames(&self) -> bool {
        self.write_frames
    }
}
