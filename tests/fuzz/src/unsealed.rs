//! Recordings without checksums and compression, which mutations would not get past.

/// Opcodes of MCAP records.
mod op {
    pub const FOOTER: u8 = 0x02;
    pub const CHUNK: u8 = 0x06;
    pub const DATA_END: u8 = 0x0f;
}

const MAGIC_BYTES: usize = 8;

/// The same records with chunks inflated and checksums absent; none if it is no MCAP file.
pub fn unsealed(file: &[u8]) -> Option<Vec<u8>> {
    let (magic, mut rest) = file.split_at_checked(MAGIC_BYTES)?;
    let mut unsealed = magic.to_vec();
    while let Some((opcode, body, behind)) = record(rest) {
        let body = match opcode {
            op::CHUNK => open_chunk(body).unwrap_or_else(|| body.to_vec()),
            op::DATA_END | op::FOOTER => without_checksum(body),
            _ => body.to_vec(),
        };
        unsealed.push(opcode);
        unsealed.extend((body.len() as u64).to_le_bytes());
        unsealed.extend(body);
        rest = behind;
    }
    unsealed.extend(rest);
    Some(unsealed)
}

/// Kind and fields of the first record, and what stands behind it.
fn record(bytes: &[u8]) -> Option<(u8, &[u8], &[u8])> {
    let (&opcode, rest) = bytes.split_first()?;
    let (length, rest) = rest.split_first_chunk()?;
    let (body, behind) = rest.split_at_checked(u64::from_le_bytes(*length).try_into().ok()?)?;
    Some((opcode, body, behind))
}

/// Both records end in a checksum of four bytes; 0 means that there is none.
fn without_checksum(body: &[u8]) -> Vec<u8> {
    let mut body = body.to_vec();
    let end = body.len().saturating_sub(4);
    body[end..].fill(0);
    body
}

/// The chunk as one without compression or checksum.
fn open_chunk(body: &[u8]) -> Option<Vec<u8>> {
    let (times, rest) = body.split_at_checked(16)?;
    let (_sizes, rest) = rest.split_at_checked(12)?;
    let data = rest.strip_prefix(b"\x04\0\0\0zstd")?.get(8..)?;
    let records = zstd::bulk::decompress(data, 1 << 20).ok()?;
    let size = (records.len() as u64).to_le_bytes();
    let no_checksum_no_compression = [0; 8];
    Some([times, &size, &no_checksum_no_compression, &size, &records].concat())
}
