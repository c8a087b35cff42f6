#pragma once
// The heads of the HTTP front: which requests are taken, and how a response begins. Without sockets.

#include <boost/beast/http/buffer_body.hpp>
#include <boost/beast/http/parser.hpp>

#include <string>
#include <string_view>

#include "cache/server/http_face.h"

namespace kiln {

namespace beast = boost::beast;
namespace http = boost::beast::http;

// Of a head, what its grammar leaves open: whether the request's end is certain, and the fields that matter.
struct HeadCheck {
    unsigned status = 0;  // not 0: refuse with it
    bool expects_continue = false, keep_alive = false;
    HttpHead head;
};
HeadCheck check_head(const http::request_parser<http::buffer_body>& parser);
bool has_folded_line(std::string_view head);
std::string response_head(const HttpResponse& response, bool close);

}  // namespace kiln
