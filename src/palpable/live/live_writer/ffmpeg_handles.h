/// @file
/// Owning handles of FFmpeg's objects. Only for .cpp files of this module.
#pragma once

extern "C" {
#include <libavcodec/avcodec.h>
#include <libavformat/avformat.h>
#include <libavutil/opt.h>
#include <libswscale/swscale.h>
}

#include <memory>

namespace palpable {

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

}  // namespace palpable
