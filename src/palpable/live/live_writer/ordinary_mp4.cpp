#include "palpable/live/live_writer/ordinary_mp4.h"

#include "palpable/live/live_writer/ffmpeg_handles.h"

#include <string>
#include <system_error>

namespace palpable {
namespace {

namespace fs = std::filesystem;

// With the prefix FFmpeg does not read a name that contains a colon as a protocol.
std::string url_of(const fs::path& path) { return "file:" + path.string(); }

struct CloseInput {
  void operator()(AVFormatContext* input) const { avformat_close_input(&input); }
};
using Input = std::unique_ptr<AVFormatContext, CloseInput>;

Input open_film(const fs::path& path) {
  AVFormatContext* input = nullptr;
  if (avformat_open_input(&input, url_of(path).c_str(), nullptr, nullptr) < 0) return nullptr;
  return Input(input);
}

// An MP4 with one stream of the same format, or null.
Container container_like(const AVStream& stream) {
  AVFormatContext* made = nullptr;
  if (avformat_alloc_output_context2(&made, nullptr, "mp4", nullptr) < 0) return nullptr;
  Container container(made);
  AVStream* copy = avformat_new_stream(made, nullptr);
  if (copy == nullptr || avcodec_parameters_copy(copy->codecpar, stream.codecpar) < 0)
    return nullptr;
  copy->codecpar->codec_tag = 0;  // let the muxer choose its own tag for this codec
  copy->time_base = stream.time_base;
  copy->avg_frame_rate = stream.avg_frame_rate;
  return container;
}

// Copies all packets; the first picture is shown at time 0. False when one could not be written.
bool copy_packets(AVFormatContext& from, AVFormatContext& to) {
  const Packet packet(av_packet_alloc());
  if (!packet) return false;
  int read = 0;
  while ((read = av_read_frame(&from, packet.get())) >= 0) {
    av_packet_rescale_ts(packet.get(), from.streams[0]->time_base, to.streams[0]->time_base);
    packet->pos = -1;
    if (av_write_frame(&to, packet.get()) < 0) return false;
    av_packet_unref(packet.get());
  }
  return read == AVERROR_EOF;
}

bool copy_film(const fs::path& from, const fs::path& to) {
  const Input input = open_film(from);
  if (!input || input->nb_streams != 1) return false;
  const Container output = container_like(*input->streams[0]);
  if (!output || avio_open(&output->pb, url_of(to).c_str(), AVIO_FLAG_WRITE) < 0) return false;
  const bool copied = avformat_write_header(output.get(), nullptr) >= 0 &&
                      copy_packets(*input, *output) && av_write_trailer(output.get()) >= 0;
  avio_flush(output->pb);
  const bool taken = output->pb->error >= 0;
  return avio_closep(&output->pb) >= 0 && copied && taken;
}

}  // namespace

bool make_ordinary_mp4(const fs::path& film) {
  fs::path part = film;
  part += ".part";
  std::error_code error;
  if (copy_film(film, part)) {
    fs::rename(part, film, error);
    if (!error) return true;
  }
  fs::remove(part, error);
  return false;
}

}  // namespace palpable
