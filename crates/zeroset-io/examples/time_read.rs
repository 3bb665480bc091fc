//! Prints how long reading each of the files given takes.

use std::time::Instant;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    for path in std::env::args_os().skip(1).map(std::path::PathBuf::from) {
        for _ in 0..3 {
            let start = Instant::now();
            let file = zeroset_io::read_cloud(&path)?;
            println!("{:8.3} s  {:>9} points  {}", start.elapsed().as_secs_f64(), file.cloud.len(), path.display());
            if std::env::var_os("VERBOSE").is_some() {
                println!("{:#?} {:?}", file.report, file.cloud.world(0));
            }
        }
    }
    Ok(())
}
