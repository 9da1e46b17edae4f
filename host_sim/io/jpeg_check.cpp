#include "host_sim/io/jpeg_check.hpp"

#include <algorithm>
#include <array>
#include <csetjmp>
#include <cstdio>  // what jpeglib.h needs before it
#include <jerror.h>
#include <jpeglib.h>
#include <vector>

namespace cairn::host {
namespace {

struct Errors {
  jpeg_error_mgr base;  ///< first, so that libjpeg's pointer is one to this
  std::jmp_buf leave;
  std::array<char, JMSG_LENGTH_MAX> damage;
};

bool is_damage(int code) {
  switch (code) {
    case JWRN_HIT_MARKER:
    case JWRN_HUFF_BAD_CODE:
    case JWRN_JPEG_EOF:
    case JWRN_MUST_RESYNC:
    case JWRN_NOT_SEQUENTIAL:
    case JWRN_BOGUS_PROGRESSION:
      return true;
    default:
      return false;
  }
}

void note(j_common_ptr jpeg) {
  auto* errors = reinterpret_cast<Errors*>(jpeg->err);
  if (errors->damage[0] == '\0') errors->base.format_message(jpeg, errors->damage.data());
}

/// Whether what was passed over before a marker is data that no decoder asked for, and not the
/// padding that some cameras write there.
bool skips_data(j_common_ptr jpeg) {
  constexpr std::ptrdiff_t kMarkers = 8;
  const jpeg_source_mgr& source = *reinterpret_cast<j_decompress_ptr>(jpeg)->src;
  const JOCTET* end = source.next_input_byte;
  const auto padding = [](JOCTET byte) { return byte == 0x00 || byte == 0xFF; };
  const std::ptrdiff_t passed_over = jpeg->err->msg_parm.i[0];
  return passed_over - std::count_if(end - passed_over, end, padding) > kMarkers;
}

void note_message(j_common_ptr jpeg, int level) {
  if (level >= 0) return;
  const int code = jpeg->err->msg_code;
  if (is_damage(code) || (code == JWRN_EXTRANEOUS_DATA && skips_data(jpeg))) note(jpeg);
}

[[noreturn]] void leave(j_common_ptr jpeg) {
  note(jpeg);
  std::longjmp(reinterpret_cast<Errors*>(jpeg->err)->leave, 1);
}

/// No object with a destructor lives here: libjpeg leaves it by a jump.
void decode(jpeg_decompress_struct& jpeg, Errors& errors, std::string_view bytes,
            std::vector<unsigned char>& row) {
  if (setjmp(errors.leave) != 0) return;  // NOLINT(cert-err52-cpp): libjpeg's way to report errors
  jpeg_mem_src(&jpeg, reinterpret_cast<const unsigned char*>(bytes.data()),
               static_cast<unsigned long>(bytes.size()));
  jpeg_read_header(&jpeg, TRUE);
  jpeg.dct_method = JDCT_IFAST;
  jpeg.do_fancy_upsampling = FALSE;
  jpeg_start_decompress(&jpeg);
  row.resize(static_cast<std::size_t>(jpeg.output_width) *
             static_cast<std::size_t>(jpeg.output_components));
  while (jpeg.output_scanline < jpeg.output_height) {
    JSAMPROW line = row.data();
    jpeg_read_scanlines(&jpeg, &line, 1);
  }
  jpeg_finish_decompress(&jpeg);
}

}  // namespace

std::string find_jpeg_damage(std::string_view bytes) {
  Errors errors{};
  jpeg_decompress_struct jpeg{};
  jpeg.err = jpeg_std_error(&errors.base);
  errors.base.emit_message = note_message;
  errors.base.error_exit = leave;
  std::vector<unsigned char> row;
  jpeg_create_decompress(&jpeg);
  decode(jpeg, errors, bytes, row);
  jpeg_destroy_decompress(&jpeg);
  return errors.damage.data();
}

}  // namespace cairn::host
