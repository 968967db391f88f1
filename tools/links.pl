#!/usr/bin/perl
# Checks what the documents point to:   tools/links.pl
#                                       tools/links.pl --write   sets the definitions of [§n] first
#   - relative links of every *.md: the file and, in a *.md, the heading (by GitHub's rule for anchors);
#   - references [§n]: defined in their file, leading to the heading "§n" under docs/theory, none unused;
#   - §n in sources, tests, tools and examples: that section stands in docs/theory;
#   - CONTRIBUTING.md names every folder of src/;
#   - paths in backticks that begin with a folder of this repository: something stands there.
# Prints every finding as file:line: message; exit code 1 when there is one.  Perl comes with git.
use strict;
use warnings;
use utf8;
use open qw(:std :encoding(UTF-8));
use File::Basename qw(dirname);
use File::Find qw(find);

chdir dirname($0) . '/..' or die "$0: $!";
my ($findings, @markdown, @sources) = (0);

sub complain { print "$_[0]:$_[1]: $_[2]\n"; $findings++; }

sub lines_of {
  open my $in, '<', $_[0] or die "$_[0]: $!";
  my @lines = <$in>;
  chomp @lines;
  return @lines;
}

# "theory/../a.md" -> "a.md"
sub plain {
  my @parts;
  for (split m{/}, $_[0]) {
    next if $_ eq '' || $_ eq '.';
    if ($_ eq '..') { pop @parts } else { push @parts, $_ }
  }
  return join '/', @parts;
}

sub wanted {
  return $File::Find::prune = 1 if /^(\.git|build.*|out)$/ && -d;
  (my $path = $File::Find::name) =~ s{^\./}{};
  return unless -f;
  if (/\.md$/) { push @markdown, $path }
  elsif ($path =~ m{^(src|tests|tools|benchmarks|examples|cmake|fuzz)/} && /\.(hpp|cpp|toml|sh|pl|cmake|txt)$/) {
    push @sources, $path;
  }
}
find({wanted => \&wanted, preprocess => sub { sort @_ }}, '.');

# Headings of every document as anchors; sections of the theory.
my (%anchors, %section, %text);
for my $file (@markdown) {
  my ($fence, %seen) = (0);
  for (lines_of($file)) {
    if (/^\s*```/) { $fence = !$fence; push @{$text{$file}}, ''; next }
    push @{$text{$file}}, $fence ? '' : $_;
    next if $fence || !/^#+ +(.*?)\s*$/;
    (my $anchor = lc $1) =~ s/[^\w\- ]//g;
    $anchor =~ tr/ /-/;
    my $twin = $seen{$anchor}++;
    $anchors{$file}{$twin ? "$anchor-$twin" : $anchor} = 1;
    next unless $file =~ m{^docs/theory/} && /^## §(\d+) /;
    complain($file, scalar @{$text{$file}}, "§$1 stands in $section{$1} too") if $section{$1};
    $section{$1} = "$file#$anchor";
  }
}

# Replaces the definitions at the end of a document by those of the sections that it refers to.
sub write_definitions {
  my ($file) = @_;
  my (%used, $definitions);
  for (grep { !/^#|^\[§\d+\]: / } @{$text{$file}}) {
    (my $prose = $_) =~ s/`[^`]*`//g;
    $used{$1} = 1 while $prose =~ /\[§(\d+)\]/g;
  }
  my @lines = grep { !/^\[§\d+\]: / } lines_of($file);
  pop @lines while @lines && $lines[-1] eq '';
  for my $n (sort { $a <=> $b } grep { $section{$_} } keys %used) {
    my ($path, $anchor) = split /#/, $section{$n};
    my @to = split m{/}, $path;
    my @from = split m{/}, $file;
    while (@from > 1 && @to > 1 && $from[0] eq $to[0]) { shift @from; shift @to }
    my $target = $path eq $file ? '' : join('/', ('..') x (@from - 1), @to);
    $definitions .= "[§$n]: $target#$anchor\n";
  }
  my $new = join("\n", @lines) . "\n" . (defined $definitions ? "\n$definitions" : '');
  return if $new eq join("\n", lines_of($file)) . "\n";
  open my $out, '>', $file or die "$file: $!";
  print $out $new;
  close $out;
  push @{$text{$file}}, '', split /\n/, $definitions // '';
}
if (@ARGV && $ARGV[0] eq '--write') { write_definitions($_) for @markdown }

sub check_link {
  my ($file, $line, $target) = @_;
  return if $target =~ m{^(https?|mailto):};
  my ($path, $anchor) = split /#/, $target, 2;
  $path = $path eq '' ? $file : plain(dirname($file) . "/$path");
  if (!-e $path) { complain($file, $line, "link to $path, which does not exist") }
  elsif (defined $anchor && $path =~ /\.md$/ && !$anchors{$path}{$anchor}) {
    complain($file, $line, "link to $path#$anchor: no such heading");
  }
  return "$path" . (defined $anchor ? "#$anchor" : '');
}

for my $file (@markdown) {
  my (%defined, %used);
  my $line = 0;
  for (@{$text{$file}}) {
    $line++;
    if (/^\[([^\]]+)\]: +(\S+)/) {
      my ($name, $target) = ($1, check_link($file, $line, $2));
      $defined{$name} = $line;
      if ($name =~ /^§(\d+)$/ && ($section{$1} // '') ne ($target // '')) {
        complain($file, $line, "[$name] leads to $target, the section is " . ($section{$1} // 'nowhere'));
      }
      next;
    }
    (my $prose = $_) =~ s/`[^`]*`//g;
    check_link($file, $line, $1) while $prose =~ /\]\(([^)\s]+)\)/g;
    while ($prose =~ /(\[?)§(\d+)(\]?)/g) {
      if (/^#/) { next }
      if ($1 eq '' || $3 eq '') { complain($file, $line, "§$2 is not a link: write [§$2]") }
      $used{"§$2"} = $line;
    }
    while (/`((?:src|tests|docs|data|examples|tools|benchmarks|fuzz|cmake)\/[\w.\/-]*\w)`/g) {
      my $path = $1;
      next if grep { -e $_ } $path, "$path.cpp", "$path.hpp";
      complain($file, $line, "`$path` does not exist");
    }
  }
  for my $name (sort keys %used) {
    complain($file, $used{$name}, "[$name] has no definition in this file") unless $defined{$name};
  }
  for my $name (grep { /^§/ } sort keys %defined) {
    complain($file, $defined{$name}, "[$name] is not used") unless $used{$name};
  }
}

for my $file (@sources) {
  my $line = 0;
  for (lines_of($file)) {
    $line++;
    while (/§(\d+)/g) {
      complain($file, $line, "§$1: no such section in docs/theory") unless $section{$1};
    }
    complain($file, $line, "docs/$1 does not exist") if m{\bdocs/([\w/-]+\.md)\b} && !-e "docs/$1";
  }
}
# The plan in CONTRIBUTING.md has every room of src/.
my $plan = join "\n", lines_of('CONTRIBUTING.md');
for my $room (grep { -d } glob 'src/* src/calibrate/* src/io/*') {
  my ($last) = $room =~ m{([^/]+)$};
  complain('CONTRIBUTING.md', 1, "$room/ is not in the plan") unless $plan =~ m{(^|\s)$last/}m;
}
exit($findings ? 1 : 0);
