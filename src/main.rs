//! The program `rmpm`.

fn main() -> std::process::ExitCode {
    rmpm::cli::main()
}
