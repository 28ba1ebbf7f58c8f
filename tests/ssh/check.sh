#!/bin/bash
# Attacks a host through OpenSSH as a participant: with an account, with the shared account, and on the socket.
# Usage: tests/ssh/check.sh NOVAMIND. Needs root, sshd, ssh, python3 and setpriv; it creates accounts nmtest-* and removes them.
set -u
novamind=$(readlink -f "$1")
repository=$(cd "$(dirname "$0")/../.." && pwd)
work=$(mktemp -d /tmp/novamind-ssh.XXXXXX)
chmod 755 "$work"
port=22022
accounts="nmtest-01 nmtest-02 nmtest-play"
failures=0
host_process= sshd_process=

clean_up() {
    [ -n "$sshd_process" ] && kill "$sshd_process"
    [ -n "$host_process" ] && kill "$host_process" && wait "$host_process"
    for account in $accounts; do userdel "$account"; done
    groupdel nmtest-players
    rm -rf "$work"
} 2>/dev/null
trap clean_up EXIT

pass() { echo "ok    $1"; }
fail() { echo "WRONG $1"; sed 's/^/      /' "$work/out" | cat -v | tail -n 15; failures=$((failures + 1)); }
# A check that a text is, or is not, in the output of the last attack.
shows() { if grep -aqF "$2" "$work/out"; then pass "$1"; else fail "$1"; fi; }
hides() { if grep -aqF "$2" "$work/out"; then fail "$1"; else pass "$1"; fi; }

# The study, with secret seeds.
"$novamind" study new "$work/pilot" >/dev/null
cat > "$work/pilot/study.toml" <<'END'
name = "pilot"
title = "Running a company"
[seeds]
plan = "secret"
count = 2
[practice]
offer = "none"
END
"$novamind" study assign "$work/pilot" --participants 2 --prefix nmtest- >/dev/null
"$novamind" host links "$work/pilot" --csv "$work/links.csv" >/dev/null || exit 1
code_of() { awk -F, -v label="$1" '$1 == label { print $3 }' "$work/links.csv"; }
seed=$(awk -F, '$1 == "nmtest-02" { print $3 }' "$work/pilot/assignment.csv")

# Accounts with the code as password.
groupadd nmtest-players
for account in $accounts; do
    useradd --no-create-home --home-dir /nonexistent --shell /bin/sh --groups nmtest-players "$account"
done
for account in nmtest-01 nmtest-02; do echo "$account:$(code_of $account)"; done | chpasswd
echo "nmtest-play:shared-password" | chpasswd

# The host and its sshd, with the configuration of the documentation.
mkdir -p /run/sshd "$work/run"
install -m 755 "$novamind" "$work/novamind"
"$work/novamind" host --study "$work/pilot" --listen 127.0.0.1:22079 --socket "$work/run/host.sock" --shared-account nmtest-play > "$work/host.log" 2>&1 &
host_process=$!
ssh-keygen -q -t ed25519 -N '' -f "$work/host_key"
sed -e "s|^Port .*|Port $port\nListenAddress 127.0.0.1|" -e "s|^HostKey .*|HostKey $work/host_key|" \
    -e "s|^PidFile .*|PidFile $work/sshd.pid|" -e "s|novamind-players|nmtest-players|" \
    -e "s|/usr/bin/novamind|$work/novamind|" -e "s|/run/novamind/host.sock|$work/run/host.sock|" \
    "$repository/packaging/host/sshd_config" > "$work/sshd_config"
/usr/sbin/sshd -t -f "$work/sshd_config" || exit 1
/usr/sbin/sshd -D -f "$work/sshd_config" -E "$work/sshd.log" &
sshd_process=$!
for _ in $(seq 100); do [ -S "$work/run/host.sock" ] && [ -f "$work/sshd.pid" ] && break; sleep 0.1; done

printf '#!/bin/sh\nprintf "%%s\\n" "$PASSWORD"\n' > "$work/askpass"
chmod 700 "$work/askpass"
export SSH_ASKPASS="$work/askpass" SSH_ASKPASS_REQUIRE=force DISPLAY=none
options="-p $port -o StrictHostKeyChecking=no -o UserKnownHostsFile=/dev/null -o LogLevel=ERROR -o NumberOfPasswordPrompts=1"
# Runs ssh as an account; keys come from standard input.
attack() {
    local account=$1
    shift
    PASSWORD=$(code_of "$account")
    [ "$account" = nmtest-play ] && PASSWORD=shared-password
    PASSWORD=$PASSWORD timeout 20 ssh $options "$@" "$account@127.0.0.1" ${COMMAND:+"$COMMAND"} > "$work/out" 2>&1
}
# Waits, then types; keeps the connection for a while.
keys() { sleep 3; printf '%b' "$1"; sleep 2; }

keys '' | attack nmtest-01 -tt
shows "a participant sees the session" "Running a company"
PASSWORD=wrong timeout 20 ssh $options -tt nmtest-01@127.0.0.1 > "$work/out" 2>&1 </dev/null
shows "a wrong password is refused" "Permission denied"
COMMAND=id attack nmtest-01 </dev/null
hides "a command is not executed" "uid="
shows "without a terminal, the reason is shown" "needs a terminal"
keys '' | COMMAND="$work/novamind host attach nmtest-02 --socket $work/run/host.sock" attack nmtest-01 -tt
if grep -q '"event":"attached","label":"nmtest-02"' "$work/pilot/host/audit.jsonl"; then fail "another label is not opened"; else pass "another label is not opened"; fi
COMMAND='$(id)' attack nmtest-01 </dev/null
hides "a shell substitution is not executed" "uid="
keys '' | attack nmtest-01 -tt -o SetEnv="LD_PRELOAD=/tmp/evil.so NOVAMIND_HOST_SOCKET=/tmp/evil BASH_ENV=/tmp/evil ENV=/tmp/evil NOVAMIND_STUDY=/tmp"
shows "environment variables have no effect" "Running a company"
hides "environment variables do not reach the program" "evil"

echo text > "$work/upload"
export PASSWORD=$(code_of nmtest-01)
copy="-P $port -o StrictHostKeyChecking=no -o UserKnownHostsFile=/dev/null -o NumberOfPasswordPrompts=1"
timeout 20 scp -O $copy "$work/upload" nmtest-01@127.0.0.1:/tmp/nmtest-upload > "$work/out" 2>&1
timeout 20 scp $copy "$work/upload" nmtest-01@127.0.0.1:/tmp/nmtest-upload >> "$work/out" 2>&1
timeout 20 scp -O $copy nmtest-01@127.0.0.1:/etc/passwd "$work/passwd" >> "$work/out" 2>&1
if [ -e /tmp/nmtest-upload ] || [ -s "$work/passwd" ]; then fail "scp copies nothing"; else pass "scp copies nothing"; fi
echo "get /etc/passwd $work/passwd" | timeout 20 sftp $copy nmtest-01@127.0.0.1 > "$work/out" 2>&1
if [ -s "$work/passwd" ]; then fail "sftp reads nothing"; else pass "sftp reads nothing"; fi

# Forwarding: a listener of the host's machine must not be reachable through the connection.
python3 -m http.server 22080 --bind 127.0.0.1 --directory /tmp >/dev/null 2>&1 &
listener=$!
(sleep 3; timeout 5 curl -s http://127.0.0.1:22081/ > "$work/forwarded"; sleep 2) | attack nmtest-01 -tt -L 22081:127.0.0.1:22080
if [ -s "$work/forwarded" ]; then fail "-L reaches nothing"; else pass "-L reaches nothing"; fi
(sleep 3; timeout 5 curl -s --socks5 127.0.0.1:22082 http://127.0.0.1:22080/ > "$work/forwarded"; sleep 2) | attack nmtest-01 -tt -D 22082
if [ -s "$work/forwarded" ]; then fail "-D reaches nothing"; else pass "-D reaches nothing"; fi
attack nmtest-01 -W 127.0.0.1:22080 </dev/null
hides "-W reaches nothing" "HTTP"
(sleep 3; timeout 3 bash -c 'exec 3<>/dev/tcp/127.0.0.1/22083' 2>/dev/null && echo open > "$work/reverse"; sleep 2) | attack nmtest-01 -tt -R 22083:127.0.0.1:22080
if [ -s "$work/reverse" ]; then fail "-R listens nowhere"; else pass "-R listens nowhere"; fi
(sleep 3; timeout 3 curl -s --unix-socket "$work/local.sock" http://host/ > "$work/forwarded" 2>&1; echo "curl: $?" >> "$work/forwarded"; sleep 1) |
    attack nmtest-01 -tt -L "$work/local.sock:$work/run/host.sock"
cp "$work/forwarded" "$work/out"
# The socket answers nothing to HTTP, but a forwarded connection would stay open until the time limit (28).
hides "the socket cannot be forwarded" "curl: 28"
kill $listener
attack nmtest-01 -w 0:0 -N </dev/null
hides "a tunnel is not opened" "tun0"

# Signals and control characters.
keys '\003\032\034\021\023' | attack nmtest-01 -tt
hides "control characters do not reach a shell" "Stopped"
hides "control characters print no core" "core dumped"
keys '\033P+q544e\033\\\033[6n\033]52;c;?\007\033[?1049l\033c\033[8;999;999t' | attack nmtest-01 -tt
keys '' | attack nmtest-01 -tt
shows "escape sequences leave the session usable" "Running a company"
(sleep 3; head -c 2000000 /dev/urandom | base64 -w 0; sleep 2) | attack nmtest-01 -tt
keys '' | attack nmtest-01 -tt
shows "two megabytes of keys leave the session usable" "Running a company"

# Two clients.
(sleep 9) | PASSWORD=$(code_of nmtest-01) timeout 20 ssh $options -tt nmtest-01@127.0.0.1 > "$work/first" 2>&1 &
sleep 3
keys '' | attack nmtest-01 -tt
wait $!
cp "$work/first" "$work/out"
shows "the first client is informed of the second" "opened in another window"

# The shared account.
(sleep 2; printf 'nmtest-02\n'; sleep 1; printf 'aaaaa-aaaaa\n'; sleep 3; printf 'nmtest-02\n'; sleep 1; printf '%s\n' "$(code_of nmtest-01)"; sleep 3) | attack nmtest-play -tt
hides "a wrong code opens no session" "Running a company"
(sleep 2; printf 'nmtest-02\n'; sleep 1; printf '%s\n' "$(code_of nmtest-02)"; sleep 4) | attack nmtest-play -tt
shows "label and code open the session" "Running a company"

# The socket, without ssh, as an account with a shell.
cat > "$work/client.py" <<'END'
import json, socket, struct, sys
def ask(message):
    connection = socket.socket(socket.AF_UNIX)
    connection.settimeout(5)
    connection.connect(sys.argv[1])
    data = message if isinstance(message, bytes) else json.dumps(message).encode()
    connection.sendall(data if isinstance(message, bytes) else struct.pack(">I", len(data)) + data)
    try:
        return connection.recv(65536)
    except (OSError, TimeoutError) as error:
        return repr(error).encode()
hello = lambda label: {"Hello": {"label": label, "columns": 80, "rows": 24}}
for message in [hello("nmtest-02"), hello("../nmtest-02"), hello("nmtest-01\0"), {"Code": {"label": "nmtest-02", "code": ""}},
                b"\xff\xff\xff\xff", b"GET / HTTP/1.1\r\n\r\n", struct.pack(">I", 9) + b"[[[[[[[[["]:
    print(message, ask(message)[4:200])
END
chmod 644 "$work/client.py"
run_as() { setpriv --reuid "$1" --regid "$1" --clear-groups "${@:2}"; }
run_as nmtest-01 /usr/bin/python3 "$work/client.py" "$work/run/host.sock" > "$work/out" 2>&1
shows "the socket refuses another label" "can open only the session"
hides "the socket attaches no other label" "Attached"
setpriv --no-new-privs /usr/bin/python3 "$work/client.py" "$work/run/host.sock" > "$work/out" 2>&1
shows "a restricted process with the account of the host is refused" "restricted processes"
hides "a restricted process attaches to no session" "Attached"
run_as nmtest-01 sh -c "cat $work/pilot/assignment.csv $work/pilot/host/host.toml $work/pilot/host/sessions/*/study/* ; ls -R $work/pilot/host/" > "$work/out" 2>&1
hides "an account reads no file of the host" "digest"
run_as nmtest-01 sh -c "cat $work/pilot/host/access.json; tr '\0' '\n' < /proc/$host_process/environ; kill $host_process; kill -9 $host_process" > "$work/out" 2>&1
if kill -0 $host_process; then pass "an account cannot end the host"; else fail "an account cannot end the host"; fi
grep -raF "$seed" "$work"/out "$work"/first "$work"/links.csv > "$work/found"
if [ -s "$work/found" ]; then fail "no seed was printed"; else pass "no seed was printed"; fi

# The end: all sessions save, and the audit log is complete.
kill "$host_process"; wait "$host_process"; status=$?
host_process=
cp "$work/host.log" "$work/out"
[ $status = 0 ] && pass "the host ends with exit code 0" || fail "the host ends with exit code 0 (it was $status)"
python3 - "$work/pilot/host/audit.jsonl" > "$work/out" 2>&1 <<'END'
import collections, json, sys
lines = [json.loads(line) for line in open(sys.argv[1])]
print(dict(collections.Counter(line["event"] for line in lines)))
assert lines[-1]["event"] == "host_stopped"
END
[ $? = 0 ] && pass "the audit log is complete: $(cat "$work/out")" || fail "the audit log is complete"
[ $failures = 0 ] || { echo "$failures checks failed"; exit 1; }
