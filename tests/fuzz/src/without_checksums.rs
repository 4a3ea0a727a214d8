//! Removes checksums and compression from recordings, so that mutations are not rejected early.

/// Opcodes of MCAP records.
mod op {
    pub const FOOTER: u8 = 0x02;
    pub const CHUNK: u8 = 0x06;
    pub const DATA_END: u8 = 0x0f;
}

const MAGIC_BYTES: usize = 8;

/// Returns the same records with decompressed chunks and without checksums, or `None` if the file is
/// too short for the magic bytes.
pub fn without_checksums(file: &[u8]) -> Option<Vec<u8>> {
    let (magic, mut rest) = file.split_at_checked(MAGIC_BYTES)?;
    let mut stripped = magic.to_vec();
    while let Some((opcode, body, remaining)) = split_record(rest) {
        let body = match opcode {
            op::CHUNK => decompress_chunk(body).unwrap_or_else(|| body.to_vec()),
            op::DATA_END | op::FOOTER => clear_checksum(body),
            _ => body.to_vec(),
        };
        stripped.push(opcode);
        stripped.extend((body.len() as u64).to_le_bytes());
        stripped.extend(body);
        rest = remaining;
    }
    stripped.extend(rest);
    Some(stripped)
}

/// Returns opcode and fields of the first record, and the bytes after it.
fn split_record(bytes: &[u8]) -> Option<(u8, &[u8], &[u8])> {
    let (&opcode, rest) = bytes.split_first()?;
    let (length, rest) = rest.split_first_chunk()?;
    let (body, remaining) = rest.split_at_checked(u64::from_le_bytes(*length).try_into().ok()?)?;
    Some((opcode, body, remaining))
}

/// Sets the checksum in the last four bytes of a data end or footer record to 0, which means none.
fn clear_checksum(body: &[u8]) -> Vec<u8> {
    let mut body = body.to_vec();
    let end = body.len().saturating_sub(4);
    body[end..].fill(0);
    body
}

/// Returns the chunk without compression and checksum.
fn decompress_chunk(body: &[u8]) -> Option<Vec<u8>> {
    let (times, rest) = body.split_at_checked(16)?;
    let (_sizes, rest) = rest.split_at_checked(12)?;
    let data = rest.strip_prefix(b"\x04\0\0\0zstd")?.get(8..)?;
    let records = zstd::bulk::decompress(data, 1 << 20).ok()?;
    let size = (records.len() as u64).to_le_bytes();
    let no_checksum_no_compression = [0; 8];
    Some([times, &size, &no_checksum_no_compression, &size, &records].concat())
}
