#include "palpable/live/live_writer/video_file_writer.h"

#include "palpable/common/base/contract.h"
#include "palpable/common/base/error.h"
#include "palpable/common/base/output_file.h"

#include <fmt/core.h>

extern "C" {
#include <libavcodec/avcodec.h>
#include <libavformat/avformat.h>
#include <libavutil/opt.h>
#include <libswscale/swscale.h>
}

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string>
#include <system_error>
#include <utility>

namespace palpable {
namespace {

namespace fs = std::filesystem;

// Owning handles of FFmpeg's objects.
struct FreeFfmpeg {
  void operator()(AVCodecContext* encoder) const { avcodec_free_context(&encoder); }
  void operator()(AVFormatContext* container) const { avformat_free_context(container); }
  void operator()(AVFrame* frame) const { av_frame_free(&frame); }
  void operator()(AVPacket* packet) const { av_packet_free(&packet); }
  void operator()(SwsContext* converter) const { sws_freeContext(converter); }
  void operator()(AVIOContext* stream) const {
    av_freep(&stream->buffer);
    avio_context_free(&stream);
  }
};

using Encoder = std::unique_ptr<AVCodecContext, FreeFfmpeg>;
using Container = std::unique_ptr<AVFormatContext, FreeFfmpeg>;
using VideoFrame = std::unique_ptr<AVFrame, FreeFfmpeg>;
using Packet = std::unique_ptr<AVPacket, FreeFfmpeg>;
using Converter = std::unique_ptr<SwsContext, FreeFfmpeg>;
using ByteStream = std::unique_ptr<AVIOContext, FreeFfmpeg>;

constexpr int kBuffer = 1 << 16;  // bytes
constexpr int kFineRate = 1000;   // a fractional rate is rounded to thousandths

// The type of `bytes` is const in FFmpeg 7 but not in FFmpeg 5.
template <class Byte>
int take_bytes(void* taken, Byte* bytes, int count) {
  static_cast<std::string*>(taken)->append(reinterpret_cast<const char*>(bytes),
                                           static_cast<std::size_t>(count));
  return count;
}

AVRational rate_of(double frames_per_second) {
  const double whole = std::round(frames_per_second);
  if (whole >= 1 && std::abs(whole - frames_per_second) < 1.0 / kFineRate) {
    return {static_cast<int>(whole), 1};
  }
  return {static_cast<int>(std::max(1.0, std::round(frames_per_second * kFineRate))), kFineRate};
}

VideoFrame frame_of(AVPixelFormat format, int width, int height) {
  VideoFrame frame(av_frame_alloc());
  if (!frame) return nullptr;
  frame->format = format;
  frame->width = width;
  frame->height = height;
  if (av_frame_get_buffer(frame.get(), 0) < 0) return nullptr;
  return frame;
}

// An opened encoder, or null if FFmpeg has none for this codec.
Encoder open_encoder(AVCodecID codec, int width, int height, AVRational rate) {
  const AVCodec* found = avcodec_find_encoder(codec);
  if (found == nullptr) return nullptr;
  Encoder encoder(avcodec_alloc_context3(found));
  if (!encoder) return nullptr;
  encoder->width = width;
  encoder->height = height;
  encoder->pix_fmt = AV_PIX_FMT_YUV420P;
  encoder->framerate = rate;
  encoder->time_base = av_inv_q(rate);
  encoder->flags |= AV_CODEC_FLAG_GLOBAL_HEADER;  // MP4 stores the codec's header in its own
  encoder->log_level_offset = AV_LOG_TRACE;       // no messages: a library prints nothing
  if (codec == AV_CODEC_ID_MPEG4) {
    constexpr int kQuality = 4;  // from 1 (best) to 31; about as good as x264's default
    encoder->flags |= AV_CODEC_FLAG_QSCALE;
    encoder->global_quality = kQuality * FF_QP2LAMBDA;
  }
  // The encoder runs beside the frame loop and shares its processors, so that it gets one thread
  // and x264's preset "veryfast": 0.4 times the time of the default preset (5.5 against 14 ms for a
  // 720p picture of the desk) at the same quality setting. It holds 10 pictures before it returns
  // the first; a killed run loses them. Encoders without these settings ignore them.
  encoder->thread_count = 1;
  av_opt_set(encoder->priv_data, "preset", "veryfast", 0);
  encoder->max_b_frames = 0;  // no reordering: a truncated film lacks no picture before its end
  if (avcodec_open2(encoder.get(), found, nullptr) < 0) return nullptr;
  return encoder;
}

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

// Replaces a finished fragmented MP4 by an ordinary MP4 of the same packets. The new file is
// written beside it with the suffix ".part" and renamed when it is complete, so that the disk must
// have room for both. Returns false where that fails, e.g. for lack of room; the film is then
// unchanged.
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

}  // namespace

struct VideoFileWriter::Film {
  Film(const fs::path& path_of_film, int width, int height, double frames_per_second);
  void begin();
  void send(const AVFrame* picture);
  void flush();
  void close();
  [[noreturn]] void fail(const char* what) const {
    throw Error(fmt::format("{}: {}", path.string(), what));
  }

  fs::path path;
  GrowingFile file;
  std::string taken;  // bytes from the muxer, not yet in the file
  std::string codec;
  Encoder encoder;
  ByteStream stream;  // the muxer's output, appended to `taken`
  Container container;
  Packet packet;
  VideoFrame rgb;
  VideoFrame yuv;
  Converter converter;
  std::int64_t last = -1;  // time of the last picture, in picture periods
  bool is_ending = false;  // closing or failed: nothing more can be written
};

VideoFileWriter::Film::Film(const fs::path& path_of_film, int width, int height,
                            double frames_per_second)
    : path(path_of_film), file(path) {
  const AVRational rate = rate_of(frames_per_second);
  for (const auto& [id, name] :
       {std::pair{AV_CODEC_ID_H264, "avc1"}, std::pair{AV_CODEC_ID_MPEG4, "mp4v"}}) {
    codec = name;
    encoder = open_encoder(id, width, height, rate);
    if (encoder) break;
  }
  if (!encoder) fail("no video can be written here (neither H.264 nor MPEG-4)");
  packet.reset(av_packet_alloc());
  rgb = frame_of(AV_PIX_FMT_RGB24, width, height);
  yuv = frame_of(encoder->pix_fmt, width, height);
  converter.reset(sws_getContext(width, height, AV_PIX_FMT_RGB24, width, height, encoder->pix_fmt,
                                 SWS_BICUBIC, nullptr, nullptr, nullptr));
  if (!packet || !rgb || !yuv || !converter) fail("no room for the pictures of a video");
  begin();
}

void VideoFileWriter::Film::begin() {
  AVFormatContext* made = nullptr;
  if (avformat_alloc_output_context2(&made, nullptr, "mp4", nullptr) < 0) fail("no MP4 here");
  container.reset(made);
  auto* buffer = static_cast<unsigned char*>(av_malloc(kBuffer));
  stream.reset(avio_alloc_context(buffer, kBuffer, 1, &taken, nullptr, take_bytes, nullptr));
  AVStream* track = avformat_new_stream(made, nullptr);
  if (buffer == nullptr || !stream || track == nullptr) fail("no room for a video");
  stream->seekable = 0;  // the muxer must not change bytes that are already on the disk
  made->pb = stream.get();
  made->flags |= AVFMT_FLAG_CUSTOM_IO;
  track->time_base = encoder->time_base;
  track->avg_frame_rate = encoder->framerate;
  AVDictionary* options = nullptr;
  // Fragments end only when flush() ends them. Presentation times begin at 0 although some pictures
  // are stored before others that are shown earlier.
  av_dict_set(&options, "movflags", "empty_moov+frag_custom+default_base_moof+negative_cts_offsets",
              0);
  const bool begun = avcodec_parameters_from_context(track->codecpar, encoder.get()) >= 0 &&
                     avformat_write_header(made, &options) >= 0;
  av_dict_free(&options);
  if (!begun) fail("no MP4 can be begun");
  flush();
}

// @param picture  null: the film has no further pictures
void VideoFileWriter::Film::send(const AVFrame* picture) {
  if (avcodec_send_frame(encoder.get(), picture) < 0) fail("a picture could not be encoded");
  while (true) {
    const int received = avcodec_receive_packet(encoder.get(), packet.get());
    if (received == AVERROR(EAGAIN) || received == AVERROR_EOF) return;
    if (received < 0) fail("a picture could not be encoded");
    packet->duration = 1;
    packet->stream_index = 0;
    av_packet_rescale_ts(packet.get(), encoder->time_base, container->streams[0]->time_base);
    if (av_write_frame(container.get(), packet.get()) < 0) fail("a picture could not be added");
    av_packet_unref(packet.get());
  }
}

void VideoFileWriter::Film::flush() {
  if (av_write_frame(container.get(), nullptr) < 0) fail("a piece could not be ended");
  avio_flush(stream.get());
  if (taken.empty()) return;
  is_ending = true;  // stays set if the following fails
  file.append(std::exchange(taken, {}));
  is_ending = false;
}

void VideoFileWriter::Film::close() {
  if (is_ending) return;
  is_ending = true;
  send(nullptr);
  if (av_write_trailer(container.get()) < 0) fail("the video could not be ended");
  avio_flush(stream.get());
  file.append(std::exchange(taken, {}));
  file.close();
}

VideoFileWriter::VideoFileWriter(const fs::path& path, int width, int height,
                                 double frames_per_second) {
  PALPABLE_EXPECT(width >= 2 && height >= 2 && frames_per_second > 0, "a film has pictures");
  av_log_set_level(AV_LOG_QUIET);  // the muxer and the converter have no log level of their own
  film_ = std::make_unique<Film>(path, width / 2 * 2, height / 2 * 2, frames_per_second);
}

VideoFileWriter::~VideoFileWriter() {
  try {
    film_->close();
  } catch (const Error&) {  // a destructor cannot report it; what was flushed can be played
  }
}

void VideoFileWriter::append(const ColorImage& picture, int after) {
  Film& film = *film_;
  PALPABLE_EXPECT(after >= 1, "a picture comes after the one before");
  PALPABLE_EXPECT(
      picture.width() / 2 * 2 == film.rgb->width && picture.height() / 2 * 2 == film.rgb->height,
      "all pictures of a film have one size");
  // Copied to a frame of FFmpeg's own, because its loops read beyond the end of a picture.
  if (av_frame_make_writable(film.rgb.get()) < 0 || av_frame_make_writable(film.yuv.get()) < 0) {
    film.fail("no room for a picture");
  }
  const std::size_t row = static_cast<std::size_t>(film.rgb->width) * sizeof(Rgb);
  for (int y = 0; y < film.rgb->height; ++y) {
    std::memcpy(film.rgb->data[0] + static_cast<std::ptrdiff_t>(y) * film.rgb->linesize[0],
                picture.row(y), row);
  }
  sws_scale(film.converter.get(), film.rgb->data, film.rgb->linesize, 0, film.rgb->height,
            film.yuv->data, film.yuv->linesize);
  film.last += film.last < 0 ? 1 : after;
  film.yuv->pts = film.last;
  film.send(film.yuv.get());
}

void VideoFileWriter::flush() { film_->flush(); }

void VideoFileWriter::close() {
  film_->close();
  // If there is no room for a copy the film stays fragmented and complete.
  (void)make_ordinary_mp4(film_->path);
}

const std::string& VideoFileWriter::codec() const { return film_->codec; }

}  // namespace palpable
