use std::fs;
use std::io::ErrorKind;

use proptest::prelude::*;

use super::*;
use crate::math::tensor::Voigt;
use crate::snapshot::{Snapshot, Stage};

/// `n` points with a different value in every entry, infinities and a NaN with a payload.
fn sample(n: usize) -> Snapshot {
    let real = |k: usize| move |i: usize| (i as f64 + 0.1 * k as f64).sin() / 3.0;
    let reals = |k: usize| (0..n).map(real(k)).collect::<Vec<_>>();
    let planes = |k: usize| (0..n).map(|i| [real(k)(i), -real(k + 1)(i)]).collect::<Vec<_>>();
    let stress = |i| Voigt { xx: real(20)(i), yy: -0.0, zz: real(22)(i), xy: real(23)(i) };
    let stages = [Stage::Elastic, Stage::Unloading, Stage::Softening, Stage::Residual];
    let mut s = Snapshot {
        time: 0.1 + 0.2,
        step: u64::MAX - 3,
        position: planes(1),
        reference: planes(3),
        velocity: planes(5),
        mass: reals(7),
        initial_volume: reals(8),
        jacobian: reals(9),
        stress: (0..n).map(stress).collect(),
        plastic_strain: reals(10),
        strength: reals(11),
        peak_strength: vec![f64::from_bits(0x7ff8_0000_0000_0bad); n],
        stage: (0..n).map(|i| stages[i % 4]).collect(),
        material: (0..n).map(|i| i as u16 ^ 0xa5a5).collect(),
        strain_energy: reals(12),
    };
    if n > 1 {
        s.strength[1] = f64::NEG_INFINITY;
    }
    s
}

/// Every number of a snapshot as bits.
fn bits(s: &Snapshot) -> Vec<u64> {
    let mut all = vec![s.time.to_bits(), s.step, s.len() as u64];
    for v in [&s.position, &s.reference, &s.velocity] {
        all.extend(v.iter().flatten().map(|x| x.to_bits()));
    }
    let reals = [&s.mass, &s.initial_volume, &s.jacobian, &s.plastic_strain, &s.strength, &s.peak_strength];
    for v in reals.into_iter().chain([&s.strain_energy]) {
        all.extend(v.iter().map(|x| x.to_bits()));
    }
    all.extend(s.stress.iter().flat_map(|v| [v.xx, v.yy, v.zz, v.xy]).map(f64::to_bits));
    all.extend(s.stage.iter().map(|x| *x as u64));
    all.extend(s.material.iter().map(|x| u64::from(*x)));
    all
}

fn file_of(s: &Snapshot) -> Vec<u8> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("f.vtp");
    write_vtp(&path, s).unwrap();
    fs::read(&path).unwrap()
}

fn read_bytes(bytes: &[u8]) -> std::io::Result<Snapshot> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("f.vtp");
    fs::write(&path, bytes).unwrap();
    read_vtp(&path)
}

#[test]
fn a_frame_comes_back_bit_for_bit() {
    for n in [0, 1, 2, 5, 9000] {
        let s = sample(n);
        assert_eq!(bits(&read_bytes(&file_of(&s)).unwrap()), bits(&s), "{n} points");
    }
}

#[test]
fn offsets_of_the_header_lead_to_the_lengths_of_the_arrays() {
    let n = 7_u64;
    let bytes = file_of(&sample(7));
    let text = String::from_utf8_lossy(&bytes);
    let start = text.find("raw\">").unwrap();
    let data = start + text[start..].find('_').unwrap() + 1;
    let sizes = [("Float64", 8), ("UInt64", 8), ("Int64", 8), ("UInt8", 1), ("UInt16", 2)];
    let mut end = data;
    let get =
        |tag: &str, key: &str| tag.split_once(&format!("{key}=\"")).unwrap().1.split('"').next().unwrap().to_owned();
    for tag in text[..data].split("<DataArray ").skip(1) {
        let size = sizes.iter().find(|(name, _)| *name == get(tag, "type")).unwrap().1;
        let tuples = if tag.contains("NumberOfTuples") { 1 } else { n };
        let at = data + get(tag, "offset").parse::<usize>().unwrap();
        assert_eq!(at, end, "arrays follow one another without a hole");
        let stated = u64::from_le_bytes(bytes[at..at + 8].try_into().unwrap());
        assert_eq!(stated, tuples * size * get(tag, "NumberOfComponents").parse::<u64>().unwrap());
        end = at + 8 + stated as usize;
    }
    assert_eq!(&bytes[end..], b"\n  </AppendedData>\n</VTKFile>\n");
}

#[test]
fn damage_is_an_error_that_names_the_file() {
    let good = file_of(&sample(5));
    for cut in [0, 10, 400, 2000, good.len() / 2, good.len() - 300] {
        let error = read_bytes(&good[..cut]).unwrap_err();
        assert_eq!(error.kind(), ErrorKind::InvalidData, "cut at {cut}: {error}");
        assert!(error.to_string().contains("f.vtp"));
    }
    let header_says = |from: &str, to: &str| {
        let at = good.windows(from.len()).position(|w| w == from.as_bytes()).unwrap();
        let mut bad = good[..at].to_vec();
        bad.extend(to.as_bytes());
        bad.extend(&good[at + from.len()..]);
        read_bytes(&bad).unwrap_err().kind()
    };
    // A count of 2^62 points must not be allocated.
    assert_eq!(header_says("NumberOfPoints=\"5\"", "NumberOfPoints=\"4611686018427387904\""), ErrorKind::InvalidData);
    assert_eq!(header_says("NumberOfPoints=\"5\"", "NumberOfPoints=\"6\""), ErrorKind::InvalidData);
    assert_eq!(header_says("offset=\"0\"", "offset=\"18446744073709551615\""), ErrorKind::InvalidData);
    assert_eq!(header_says("Name=\"mass\"", "Name=\"bulk\""), ErrorKind::InvalidData);
    assert_eq!(header_says("UInt8", "Int16"), ErrorKind::InvalidData);
}

#[test]
fn unequal_vectors_are_refused_and_no_file_is_left() {
    let folder = tempfile::tempdir().unwrap();
    let mut s = sample(3);
    s.jacobian.pop();
    let error = write_vtp(&folder.path().join("f.vtp"), &s).unwrap_err();
    assert_eq!(error.kind(), ErrorKind::InvalidInput);
    assert!(error.to_string().contains("2 entries of jacobian"));
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
}

#[test]
fn the_list_of_frames_comes_back() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("run.pvd");
    let frames = vec![(0.0, "frames/0.vtp".to_owned()), (0.1 + 0.2, "a \"b\" & <c>.vtp".to_owned())];
    write_pvd(&path, &frames).unwrap();
    assert_eq!(read_pvd(&path).unwrap(), frames);
    fs::write(&path, "<DataSet timestep=\"x\" file=\"a\"/>").unwrap();
    assert_eq!(read_pvd(&path).unwrap_err().kind(), ErrorKind::InvalidData);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]
    #[test]
    fn a_changed_byte_never_panics(at in 0_usize..3000, value in any::<u8>()) {
        let mut bytes = file_of(&sample(2));
        let at = at % bytes.len();
        bytes[at] = value;
        let _ = read_bytes(&bytes);
    }
}
