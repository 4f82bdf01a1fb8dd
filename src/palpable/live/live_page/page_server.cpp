#include "palpable/live/live_page/page_server.h"

#include "palpable/common/base/contract.h"
#include "palpable/common/base/json.h"
#include "palpable/live/live_page/client_queue.h"
#include "palpable/live/live_page/page_access.h"
#include "palpable/live/page/folder_server.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/posix/stream_descriptor.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/asio/write.hpp>
#include <boost/beast/core/flat_static_buffer.hpp>
#include <boost/beast/core/tcp_stream.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket.hpp>
#include <exception>
#include <future>
#include <mutex>
#include <optional>
#include <set>
#include <sys/eventfd.h>
#include <thread>
#include <tuple>
#include <unistd.h>
#include <utility>

namespace palpable {
namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = beast::http;
namespace websocket = beast::websocket;
using asio::ip::tcp;
using Trouble = beast::error_code;

constexpr std::size_t kLongestRequest = 8192;  // bytes, head of a request
constexpr std::size_t kLongestMessage = 4096;  // bytes, of a client: a list of wishes
constexpr int kMostWaitingClients = 64;        // connections that the system queues
// Bytes that the system buffers for a client: some pictures. What waits there is outdated when it
// is read.
constexpr int kSystemBuffer = 256 * 1024;
constexpr auto kFarewell = std::chrono::milliseconds(500);    // for what waits at the end
constexpr auto kLinger = std::chrono::milliseconds(500);      // for a refused client to read why
constexpr auto kAcceptPause = std::chrono::milliseconds(50);  // when there are no descriptors

// What a client wants beside lines.
struct Wishes {
  bool picture = false, skin = false;
};

// Reads {"want":["picture","skin"]}.
Result<Wishes> read_wishes(std::string_view text) {
  const Result<Json> read = Json::parse(text);
  if (!read.ok()) return read.problem();
  const Json* want = read.value().find("want");
  if (want == nullptr || !want->is_array()) {
    return Problem{"a page sends {\"want\":[...]} with picture, skin, both or none"};
  }
  Wishes wishes;
  for (const Json& word : *want) {
    const std::string* name = word.if_text();
    if (name != nullptr && *name == "picture") {
      wishes.picture = true;
    } else if (name != nullptr && *name == "skin") {
      wishes.skin = true;
    } else {
      return Problem{"\"want\" may hold picture and skin"};
    }
  }
  return wishes;
}

// How clients are greeted with a session.
struct SessionGreeting {
  std::vector<SharedBytes> greetings;
  SharedBytes triangles;
};

// What was sent since the server's thread last looked. Its memory is reused.
struct Outbox {
  struct Line {
    std::size_t end = 0;  // in `lines`
    bool is_frame = false;
  };
  std::string lines;
  std::vector<Line> ends;
  std::int64_t lost = 0;                   // lines for which there was no room
  std::optional<SessionGreeting> opening;  // another session begins
  std::size_t opens_before = 0;  // at this line; skin and picture are then of that session
  std::string missed, skin, picture;
  bool has_missed = false, has_skin = false, has_picture = false;

  void clear() {
    lines.clear();
    ends.clear();
    lost = 0;
    opening.reset();
    has_missed = has_skin = has_picture = false;
  }

  // Forgets what belongs to the session before, but for its lines.
  void open(SessionGreeting with) {
    if (opening) {  // no client was greeted with that session
      lost += static_cast<std::int64_t>(ends.size() - opens_before);
      ends.resize(opens_before);
      lines.resize(ends.empty() ? 0 : ends.back().end);
    }
    opening = std::move(with);
    opens_before = ends.size();
    has_missed = has_skin = has_picture = false;
  }
};

}  // namespace

// What the server's thread and its callers share. Everything without another comment belongs to the
// server's thread once it runs.
struct PageServer::Shared {
  class Request;
  class Client;

  explicit Shared(PageServerSettings given);
  ~Shared();

  void listen();
  void run();
  void accept();
  void read_outbox();
  void pass_on();
  void begin_session(SessionGreeting with);
  template <class Add>
  void to_all(Add add);
  void count_wishes();
  void close_all();
  void wake() const;

  PageServerSettings settings;
  int news_descriptor = -1;  // an eventfd, for any thread: the outbox holds something
  std::uint64_t news_count = 0;
  int port = 0;
  int connections = 0;  // of all kinds
  bool closing = false;
  std::set<Client*> clients;
  std::set<Request*> requests;
  SessionGreeting opening;
  SharedBytes last_skin;  // of the session; null: none
  Outbox taken;

  std::mutex outbox_mutex;
  Outbox outbox;  // guarded by it
  std::atomic<int> client_count = 0, picture_wishes = 0, skin_wishes = 0;
  std::atomic<std::uint64_t> arrivals = 0;
  mutable std::mutex counts_mutex;
  PageCounts counted;  // guarded by it

  // Last, so that they are destroyed first: connections that end with them use the above.
  asio::io_context io{1};
  tcp::acceptor acceptor{io};
  asio::steady_timer pause{io};
  asio::posix::stream_descriptor news{io};  // news_descriptor

  std::optional<std::future<void>> ended;
  std::thread thread;

  template <class Change>
  void count(Change change) {
    const std::lock_guard lock(counts_mutex);
    change(counted);
  }
};

// A connection that has not asked for the session: one request, one answer.
class PageServer::Shared::Request : public std::enable_shared_from_this<Request> {
 public:
  Request(tcp::socket socket, Shared& server) : stream_(std::move(socket)), server_(server) {
    parser_.header_limit(kLongestRequest);
    ++server_.connections;
    server_.requests.insert(this);
  }
  Request(const Request&) = delete;
  Request& operator=(const Request&) = delete;
  ~Request() {
    --server_.connections;
    server_.requests.erase(this);
  }

  void begin() {
    stream_.expires_after(server_.settings.patience);
    http::async_read(stream_, buffer_, parser_,
                     [self = shared_from_this()](Trouble trouble, std::size_t) {
                       self->is_answered_ = true;
                       self->answer(trouble);
                     });
  }

  // Closes the connection if nothing was asked yet.
  void end() {
    if (!is_answered_) stream_.close();
  }

 private:
  void answer(Trouble trouble);
  void upgrade();

  void refuse(int status) {
    if (status == 403 || status == 503) server_.count([](PageCounts& counts) { ++counts.refused; });
    body_ = fmt::format("{} {}\n", status, reason_of_status(status));
    send(status, "text/plain", body_, true);
  }

  // @param body  must live as long as this
  void send(int status, std::string_view type, std::string_view body, bool with_body) {
    head_ = fmt::format(
        "HTTP/1.1 {} {}\r\nContent-Type: {}\r\nContent-Length: {}\r\nCache-Control: no-store\r\n"
        "X-Content-Type-Options: nosniff\r\nX-Frame-Options: DENY\r\n"
        "Cross-Origin-Resource-Policy: same-origin\r\nReferrer-Policy: no-referrer\r\n"
        "Connection: close\r\n\r\n",
        status, reason_of_status(status), type, body.size());
    stream_.expires_after(server_.settings.patience);
    const std::array<asio::const_buffer, 2> parts{
        asio::buffer(head_), asio::buffer(body.data(), with_body ? body.size() : 0)};
    asio::async_write(stream_, parts, [self = shared_from_this()](Trouble, std::size_t) {
      Trouble ignored;
      self->stream_.socket().shutdown(tcp::socket::shutdown_send, ignored);
      self->stream_.expires_after(kLinger);
      self->linger();
    });
  }

  // Reads until the other side ends: TCP discards an answer that is not read yet when the socket is
  // closed with input left.
  void linger() {
    stream_.async_read_some(asio::buffer(rest_),
                            [self = shared_from_this()](Trouble trouble, std::size_t) {
                              if (!trouble) self->linger();
                            });
  }

  beast::tcp_stream stream_;
  Shared& server_;
  beast::flat_static_buffer<kLongestRequest> buffer_;
  http::request_parser<http::empty_body> parser_;
  std::string head_, body_;
  std::array<char, 512> rest_{};
  bool is_answered_ = false;
};

// A page that is shown the session.
class PageServer::Shared::Client : public std::enable_shared_from_this<Client> {
 public:
  Client(tcp::socket socket, Shared& server)
      : stream_(std::move(socket)), server_(server), queue_(server.settings.most_line_bytes) {
    ++server_.connections;
    server_.clients.insert(this);
    server_.client_count = static_cast<int>(server_.clients.size());
  }
  Client(const Client&) = delete;
  Client& operator=(const Client&) = delete;
  ~Client() {
    --server_.connections;
    server_.clients.erase(this);
    server_.client_count = static_cast<int>(server_.clients.size());
    server_.count_wishes();
    server_.count([this](PageCounts& counts) {
      counts.lost_lines += queue_.lost_lines();
      counts.lost_pictures += queue_.lost_pictures();
    });
  }

  void begin(http::request<http::empty_body> request) {
    auto& socket = beast::get_lowest_layer(stream_).socket();
    Trouble ignored;
    socket.set_option(asio::socket_base::send_buffer_size(kSystemBuffer), ignored);
    socket.set_option(tcp::no_delay(true), ignored);
    // From here on the WebSocket watches the time, by pings that the other side must answer.
    beast::get_lowest_layer(stream_).expires_never();
    const auto patience = server_.settings.patience;
    stream_.set_option(websocket::stream_base::timeout{patience, 2 * patience, true});
    stream_.read_message_max(kLongestMessage);
    stream_.auto_fragment(false);
    request_ = std::move(request);
    stream_.async_accept(request_, [self = shared_from_this()](Trouble trouble) {
      if (trouble) return;
      self->accepted_ = true;
      self->server_.count([](PageCounts& counts) { ++counts.clients; });
      ++self->server_.arrivals;
      for (const SharedBytes& line : self->server_.opening.greetings) {
        self->queue_.add_greeting(line);
      }
      self->write();
      self->read();
    });
  }

  [[nodiscard]] const Wishes& wishes() const { return wishes_; }

  // Greets with another session.
  void begin_anew() {
    if (ends()) return;
    queue_.begin_anew(server_.opening.greetings);
    has_mesh_ = has_frame_ = false;
    if (wishes_.skin) set_mesh();
    write();
  }
  void add_line(const SharedBytes& line, bool is_frame) {
    if (ends()) return;
    has_frame_ |= is_frame;
    queue_.add_line(line);
    write();
  }
  void add_missed_line(const SharedBytes& line) {
    if (!has_frame_) add_line(line, true);
  }
  void lose_lines(std::int64_t count) {
    if (!ends()) queue_.lose_lines(count);
  }
  void set_skin(const SharedBytes& skin) {
    if (ends() || !wishes_.skin) return;
    queue_.set_skin(skin);
    write();
  }
  void set_picture(const SharedBytes& picture) {
    if (ends() || !wishes_.picture) return;
    queue_.set_picture(picture);
    write();
  }

  // After what waits has been sent.
  void end(websocket::close_code code) {
    if (!close_with_) close_with_ = code;
    if (!accepted_) return beast::get_lowest_layer(stream_).close();
    write();
  }

 private:
  // Further messages are not accepted before the handshake and after the farewell.
  [[nodiscard]] bool ends() const { return !accepted_ || close_with_.has_value(); }

  void read() {
    stream_.async_read(input_, [self = shared_from_this()](Trouble trouble, std::size_t) {
      if (trouble) return self->lose(trouble);
      self->obey();
      self->input_.consume(self->input_.size());
      self->read();
    });
  }

  void obey() {
    if (close_with_) return;
    const auto data = input_.cdata();
    const Result<Wishes> wishes = read_wishes({static_cast<const char*>(data.data()), data.size()});
    if (!stream_.got_text() || !wishes.ok()) {
      server_.count([](PageCounts& counts) { ++counts.sent_away; });
      const std::string reason =
          wishes.ok() ? "a page sends text, no binary messages" : wishes.problem().message;
      queue_.add_greeting(
          std::make_shared<const std::string>(Json{{"type", "error"}, {"reason", reason}}.dump()));
      return end(websocket::close_code::policy_error);
    }
    const bool new_to_skins = wishes.value().skin && !wishes_.skin;
    const bool new_to_pictures = wishes.value().picture && !wishes_.picture;
    wishes_ = wishes.value();
    if (!wishes_.picture) queue_.drop_picture();
    if (!wishes_.skin) {
      has_mesh_ &= !queue_.has_mesh();
      queue_.drop_skin();
    }
    if (new_to_skins) {
      set_mesh();
      queue_.set_skin(server_.last_skin);
      write();
    }
    server_.count_wishes();
    if (new_to_skins || new_to_pictures) ++server_.arrivals;  // after the counts: see arrivals()
  }

  // Once a session.
  void set_mesh() {
    if (!std::exchange(has_mesh_, true)) queue_.set_mesh(server_.opening.triangles);
  }

  void write() {
    if (writing_ || closed_) return;
    message_ = queue_.next();
    if (!message_) {
      if (close_with_) close();
      return;
    }
    writing_ = true;
    stream_.text(message_->is_text);
    const std::string_view rest = message_->rest();
    const std::array<asio::const_buffer, 2> parts{asio::buffer(message_->begin),
                                                  asio::buffer(rest.data(), rest.size())};
    stream_.async_write(parts, [self = shared_from_this()](Trouble trouble, std::size_t) {
      self->writing_ = false;
      if (trouble) return self->lose(trouble);
      self->write();
    });
  }

  void close() {
    closed_ = true;
    stream_.async_close(*close_with_, [self = shared_from_this()](Trouble) {});
  }

  // Called by a read or a write that failed; the other one fails as well.
  void lose(Trouble trouble) {
    const bool first = !std::exchange(closed_, true);
    if (!first) return;
    if (trouble == beast::error::timeout) {
      server_.count([](PageCounts& counts) { ++counts.closed_behind; });
    } else if (trouble.category() == make_error_code(websocket::error::closed).category() &&
               trouble != websocket::error::closed) {
      server_.count([](PageCounts& counts) { ++counts.sent_away; });
    }
    beast::get_lowest_layer(stream_).close();
  }

  websocket::stream<beast::tcp_stream> stream_;
  Shared& server_;
  ClientQueue queue_;
  Wishes wishes_;
  http::request<http::empty_body> request_;
  beast::flat_static_buffer<kLongestMessage> input_;
  std::optional<QueuedMessage> message_;  // that is being sent
  std::optional<websocket::close_code> close_with_;
  bool accepted_ = false, writing_ = false, closed_ = false;
  // Whether it was sent the triangles, or a line of a frame, since the session began.
  bool has_mesh_ = false, has_frame_ = false;
};

void PageServer::Shared::Request::answer(Trouble trouble) {
  if (trouble) {
    // A client that sent nothing gets nothing. The rest is no request, or too long a one.
    const bool silent = trouble == beast::error::timeout || trouble == http::error::end_of_stream ||
                        trouble.category() == asio::error::get_system_category();
    return silent ? void() : refuse(400);
  }
  const auto& request = parser_.get();
  const auto text_of_view = [](beast::string_view view) {
    return std::string_view(view.data(), view.size());
  };
  const auto header = [&](http::field field) -> std::optional<std::string_view> {
    if (request.count(field) != 1) return std::nullopt;
    return text_of_view(request[field]);
  };
  const bool upgrades = websocket::is_upgrade(request);
  const PageRequest asked{
      .method = text_of_view(request.method_string()),
      .target = text_of_view(request.target()),
      .host = header(http::field::host),
      // Several origins: one text that is none.
      .origin = request.count(http::field::origin) > 1 ? "" : header(http::field::origin),
      .upgrades = upgrades};
  const PageAccess access = page_access(asked, server_.settings.token, server_.port);
  if (access.status != 200) return refuse(access.status);
  if (access.name == kLiveSocket) return upgrades ? upgrade() : refuse(400);
  const auto& files = server_.settings.files;
  const auto file = std::find_if(files.begin(), files.end(), [&](const ServedFile& other) {
    return other.name == access.name;
  });
  if (upgrades || file == files.end()) return refuse(404);
  send(200, file->type, file->bytes, asked.method == "GET");
}

void PageServer::Shared::Request::upgrade() {
  if (server_.closing ||
      static_cast<int>(server_.clients.size()) >= server_.settings.most_clients) {
    return refuse(503);
  }
  std::make_shared<Client>(stream_.release_socket(), server_)->begin(parser_.release());
}

PageServer::Shared::Shared(PageServerSettings given) : settings(std::move(given)) {
  PALPABLE_EXPECT(!settings.token.empty(), "a page has a token");
  listen();
  news_descriptor = ::eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC);
  if (news_descriptor < 0) throw Error("the page's server has no eventfd");
  news.assign(news_descriptor);
}

PageServer::Shared::~Shared() {
  if (!thread.joinable()) return;
  asio::post(io, [this] { close_all(); });
  if (ended->wait_for(kFarewell) != std::future_status::ready) io.stop();
  thread.join();
}

void PageServer::Shared::listen() {
  const tcp::endpoint address(asio::ip::address_v4::loopback(),
                              static_cast<std::uint16_t>(settings.port));
  Trouble trouble;
  acceptor.open(address.protocol(), trouble);
  // Permits the port although closed connections of an earlier run may still be in TIME_WAIT.
  if (!trouble) acceptor.set_option(asio::socket_base::reuse_address(true), trouble);
  if (!trouble) acceptor.bind(address, trouble);
  if (!trouble) acceptor.listen(kMostWaitingClients, trouble);
  if (trouble) {
    throw Error(fmt::format("127.0.0.1:{}: cannot be listened on: {}; 0 finds a free port",
                            settings.port, trouble.message()));
  }
  port = acceptor.local_endpoint().port();
}

void PageServer::Shared::run() {
  pass_on();  // the greetings come before the first client
  accept();
  read_outbox();
  // A handler may fail for want of memory; then its connection ends, and the others go on.
  for (bool goes_on = true; goes_on;) {
    try {
      io.run();
      goes_on = false;
    } catch (const std::exception&) {}
  }
}

void PageServer::Shared::accept() {
  acceptor.async_accept([this](Trouble trouble, tcp::socket socket) {
    if (closing) return;
    if (trouble) {  // no descriptors: others are closed in the meantime
      pause.expires_after(kAcceptPause);
      pause.async_wait([this](Trouble cancelled) {
        if (!cancelled && !closing) accept();
      });
      return;
    }
    if (connections < settings.most_connections) {
      std::make_shared<Request>(std::move(socket), *this)->begin();
    }
    accept();
  });
}

void PageServer::Shared::read_outbox() {
  news.async_read_some(asio::buffer(&news_count, sizeof(news_count)),
                       [this](Trouble trouble, std::size_t) {
                         if (trouble) return;
                         pass_on();
                         read_outbox();
                       });
}

void PageServer::Shared::pass_on() {
  taken.clear();
  {
    const std::lock_guard lock(outbox_mutex);
    std::swap(taken, outbox);
  }
  std::size_t begin = 0;
  for (std::size_t k = 0; k <= taken.ends.size(); ++k) {
    if (taken.opening && k == taken.opens_before) begin_session(std::move(*taken.opening));
    if (k == taken.ends.size()) break;
    const auto [end, is_frame] = taken.ends[k];
    const auto line = std::make_shared<const std::string>(taken.lines.substr(begin, end - begin));
    to_all([&, by_frame = is_frame](Client& client) { client.add_line(line, by_frame); });
    begin = end;
  }
  if (taken.lost > 0) to_all([this](Client& client) { client.lose_lines(taken.lost); });
  if (taken.has_missed) {
    const auto line = std::make_shared<const std::string>(taken.missed);
    to_all([&](Client& client) { client.add_missed_line(line); });
  }
  if (taken.has_skin) {
    last_skin = std::make_shared<const std::string>(taken.skin);
    to_all([&](Client& client) { client.set_skin(last_skin); });
  }
  if (taken.has_picture) {
    const auto picture = std::make_shared<const std::string>(taken.picture);
    to_all([&](Client& client) { client.set_picture(picture); });
  }
}

void PageServer::Shared::begin_session(SessionGreeting with) {
  opening = std::move(with);
  last_skin = nullptr;
  to_all([](Client& client) { client.begin_anew(); });
}

// Calls add(client) for each; a client may go while it is served.
template <class Add>
void PageServer::Shared::to_all(Add add) {
  std::vector<std::shared_ptr<Client>> present;
  for (Client* client : clients) present.push_back(client->shared_from_this());
  for (const auto& client : present) add(*client);
}

void PageServer::Shared::count_wishes() {
  int pictures = 0, skins = 0;
  for (const Client* client : clients) {
    pictures += client->wishes().picture ? 1 : 0;
    skins += client->wishes().skin ? 1 : 0;
  }
  picture_wishes = pictures;
  skin_wishes = skins;
}

void PageServer::Shared::close_all() {
  pass_on();
  closing = true;
  Trouble ignored;
  acceptor.close(ignored);
  pause.cancel();
  news.close(ignored);
  to_all([](Client& client) { client.end(websocket::close_code::going_away); });
  // Those that have asked nothing would hold the end up until their time is over.
  const std::vector<Request*> waiting(requests.begin(), requests.end());
  for (Request* request : waiting) request->end();
}

void PageServer::Shared::wake() const {
  const std::uint64_t one = 1;
  std::ignore = ::write(news_descriptor, &one, sizeof(one));
}

PageServer::PageServer(PageServerSettings settings)
    : shared_(std::make_unique<Shared>(std::move(settings))) {}

PageServer::~PageServer() = default;

int PageServer::port() const { return shared_->port; }
const std::string& PageServer::token() const { return shared_->settings.token; }

void PageServer::begin(std::vector<std::string> greetings, std::string mesh) {
  SessionGreeting with;
  for (std::string& line : greetings) {
    while (line.ends_with('\n')) line.pop_back();
    with.greetings.push_back(std::make_shared<const std::string>(std::move(line)));
  }
  with.triangles = std::make_shared<const std::string>(std::move(mesh));
  {
    // By the same way as what is sent, so that the order is kept.
    const std::lock_guard lock(shared_->outbox_mutex);
    shared_->outbox.open(std::move(with));
  }
  shared_->wake();
  if (shared_->thread.joinable()) return;
  std::promise<void> promise;
  shared_->ended = promise.get_future();
  shared_->thread = std::thread([shared = shared_.get(), ended = std::move(promise)]() mutable {
    shared->run();
    ended.set_value();
  });
}

bool PageServer::has_clients() const { return shared_->client_count > 0; }
bool PageServer::wants_pictures() const { return shared_->picture_wishes > 0; }
bool PageServer::wants_skins() const { return shared_->skin_wishes > 0; }
std::uint64_t PageServer::arrivals() const { return shared_->arrivals; }

void PageServer::send_line(std::string_view line, bool is_frame) {
  while (line.ends_with('\n')) line.remove_suffix(1);
  {
    const std::lock_guard lock(shared_->outbox_mutex);
    Outbox& outbox = shared_->outbox;
    // The thread is behind by seconds only if the machine is: then lines are lost here.
    if (outbox.lines.size() + line.size() > shared_->settings.most_line_bytes) {
      ++outbox.lost;
    } else {
      outbox.lines.append(line);
      outbox.ends.push_back({outbox.lines.size(), is_frame});
    }
  }
  shared_->wake();
}

void PageServer::send_missed_line(std::string_view line) {
  while (line.ends_with('\n')) line.remove_suffix(1);
  {
    const std::lock_guard lock(shared_->outbox_mutex);
    shared_->outbox.missed.assign(line);
    shared_->outbox.has_missed = true;
  }
  shared_->wake();
}

void PageServer::send_skin(std::string_view message) {
  {
    const std::lock_guard lock(shared_->outbox_mutex);
    shared_->outbox.skin.assign(message);
    shared_->outbox.has_skin = true;
  }
  shared_->wake();
}

void PageServer::send_picture(std::string_view jpeg) {
  {
    const std::lock_guard lock(shared_->outbox_mutex);
    shared_->outbox.picture.assign(jpeg);
    shared_->outbox.has_picture = true;
  }
  shared_->wake();
}

PageCounts PageServer::counts() const {
  const std::lock_guard lock(shared_->counts_mutex);
  return shared_->counted;
}

}  // namespace palpable
