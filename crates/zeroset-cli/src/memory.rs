//! How much memory there is, and how much was used.

/// Share of the free memory that is used where the user sets no limit: the rest is for the files' buffers and for
/// other programs.
const SHARE: f64 = 0.7;

/// The default limit in bytes: a share of the memory that is free, in this process's control group if that has less.
#[must_use]
pub fn default_limit() -> u64 {
    let mut system = sysinfo::System::new();
    system.refresh_memory();
    let free = system.available_memory();
    let free = system.cgroup_limits().map_or(free, |group| free.min(group.free_memory));
    (SHARE * free as f64) as u64
}

/// The largest amount of memory that this process ever had resident, in bytes; `None` where the system does not tell.
pub(crate) fn peak() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    let kibibytes: u64 = line.split_whitespace().next()?.parse().ok()?;
    Some(1024 * kibibytes)
}
